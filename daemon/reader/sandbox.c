/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader/sandbox.h"

#include "base/cleanup.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <seccomp.h>
#include <stdbool.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Differences of a build with sanitizers (SHEAR_SANITIZE); child_stderr.c has another one:
 *   memory     is not limited: the runtime maps terabytes of shadow memory, and more as the heap
 *              grows, so RLIMIT_AS would end the reader at its first allocation;
 *   options    are set here, since the reader's environment is empty. Leaks are not detected: that
 *              takes clone and ptrace, which seccomp denies. An allocation that is too large fails,
 *              as without sanitizers, and is not reported.
 * The runtime's own threads are older than the filter, which applies to the calling thread only. */
#ifdef SHEAR_SANITIZED
static const bool limits_memory = false;

const char *__asan_default_options(void);
const char *__asan_default_options(void) {
    return "detect_leaks=0:allocator_may_return_null=1";
}

const char *__tsan_default_options(void);
const char *__tsan_default_options(void) {
    return "ignore_noninstrumented_modules=1:halt_on_error=1:allocator_may_return_null=1";
}
#else
static const bool limits_memory = true;
#endif

static int fail_errno(shear_error *err, const char *what) {
    return shear_fail(
        err, SHEAR_E_IO,
        errno == EPERM ? "what runs the service forbids it (a system-call filter, a limit of its "
                         "own); see sheard(8), SECURITY"
                       : "the kernel must offer seccomp; see sheard(8), SECURITY",
        "the reader's sandbox: %s: %s", what, strerror(errno));
}

/* Set a limit to `value`, or keep that which the daemon was started with if it is lower. */
static int limit(int resource, int64_t value, const char *what, shear_error *err) {
    struct rlimit r;
    if (getrlimit((__rlimit_resource_t)resource, &r) != 0)
        return fail_errno(err, what);
    r.rlim_max = (rlim_t)value < r.rlim_max ? (rlim_t)value : r.rlim_max;
    r.rlim_cur = r.rlim_max;
    return setrlimit((__rlimit_resource_t)resource, &r) == 0 ? SHEAR_OK : fail_errno(err, what);
}

static int set_limits(const sandbox_limits *limits, shear_error *err) {
    const struct {
        int resource;
        bool wanted;
        int64_t value;
        const char *what;
    } all[] = {
        {RLIMIT_CORE, true, 0, "core size"},
        {RLIMIT_AS, limits_memory && limits->memory_bytes > 0, limits->memory_bytes, "memory"},
        {RLIMIT_CPU, limits->cpu_seconds > 0, limits->cpu_seconds, "processor time"},
        {RLIMIT_FSIZE, limits->file_bytes > 0, limits->file_bytes, "file size"},
        {RLIMIT_NOFILE, true, 64, "open files"},
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        if (all[i].wanted)
            TRY(limit(all[i].resource, all[i].value, all[i].what, err));
    }
    return SHEAR_OK;
}

/* Forbid access to files by path: without rules, Landlock refuses all handled kinds of access. */
static int enter_landlock(unsigned *guards, shear_error *err) {
    const struct landlock_ruleset_attr handled = {
        .handled_access_fs = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
                             LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR |
                             LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                             LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR |
                             LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
                             LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                             LANDLOCK_ACCESS_FS_MAKE_SYM};
    const int ruleset = (int)syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0);
    if (ruleset < 0)
        return errno == ENOSYS || errno == EOPNOTSUPP ? SHEAR_OK : fail_errno(err, "Landlock");
    const bool entered = syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
    const int code = entered ? SHEAR_OK : fail_errno(err, "Landlock rules");
    close(ruleset);
    *guards |= entered ? SANDBOX_LANDLOCK : 0U;
    return code;
}

/* The calls that CFITSIO, zlib and libc need to read a file. None of them creates processes,
 * sockets or names. */
static const int allowed[] = {
    /* open files */
    SCMP_SYS(read), SCMP_SYS(pread64), SCMP_SYS(readv), SCMP_SYS(write), SCMP_SYS(pwrite64),
    SCMP_SYS(writev), SCMP_SYS(lseek), SCMP_SYS(fstat), SCMP_SYS(ftruncate), SCMP_SYS(fallocate),
    SCMP_SYS(close), SCMP_SYS(dup),
    /* memory */
    SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(brk),
    /* threads and signals */
    SCMP_SYS(futex), SCMP_SYS(rt_sigreturn), SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(sigaltstack), SCMP_SYS(set_robust_list), SCMP_SYS(rseq), SCMP_SYS(sched_yield),
    SCMP_SYS(restart_syscall), SCMP_SYS(exit), SCMP_SYS(exit_group),
    /* the socket */
    SCMP_SYS(recvmsg), SCMP_SYS(sendmsg), SCMP_SYS(recvfrom), SCMP_SYS(sendto),
    /* what is harmless */
    SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday), SCMP_SYS(getpid), SCMP_SYS(gettid),
    SCMP_SYS(getrandom)};

/* libseccomp's macros leave a member uninitialized, which clang warns about. */
static struct scmp_arg_cmp equals(unsigned argument, scmp_datum_t value) {
    return (struct scmp_arg_cmp){.arg = argument, .op = SCMP_CMP_EQ, .datum_a = value};
}

static struct scmp_arg_cmp without(unsigned argument, scmp_datum_t bits) {
    return (struct scmp_arg_cmp){.arg = argument, .op = SCMP_CMP_MASKED_EQ, .datum_a = bits};
}

/* Allow calls with certain arguments only. mmap and mprotect must not make executable memory: all
 * code of the reader is mapped by now. The others could reach other processes of the same user,
 * such as the daemon: F_SETOWN and F_SETSIG of fcntl would send it signals; F_SETFL can enable
 * them. Return 0 or a negative errno. */
static int allow_some(scmp_filter_ctx filter) {
    const struct scmp_arg_cmp self = equals(0, (scmp_datum_t)getpid());
    const struct {
        int call;
        unsigned n;
        struct scmp_arg_cmp arguments[2];
    } rules[] = {
        {SCMP_SYS(mmap), 1, {without(2, PROT_EXEC)}},
        {SCMP_SYS(mprotect), 1, {without(2, PROT_EXEC)}},
        {SCMP_SYS(tgkill), 1, {self}}, /* abort() */
        {SCMP_SYS(fcntl), 1, {equals(1, F_GETFL)}},
        {SCMP_SYS(fcntl), 1, {equals(1, F_GETFD)}},
        {SCMP_SYS(fcntl), 1, {equals(1, F_SETFD)}},
        {SCMP_SYS(fcntl), 1, {equals(1, F_DUPFD)}},
        {SCMP_SYS(fcntl), 1, {equals(1, F_DUPFD_CLOEXEC)}},
        {SCMP_SYS(prlimit64), 2, {equals(0, 0), equals(2, 0)}}, /* getrlimit */
        {SCMP_SYS(sched_getaffinity), 1, {equals(0, 0)}},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) {
        TRY(seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, rules[i].call, rules[i].n,
                                   rules[i].arguments));
    }
    return 0;
}

static int load(scmp_filter_ctx filter) {
    TRY(allow_some(filter));
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; i++)
        TRY(seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0));
    return seccomp_load(filter);
}

static int enter_seccomp(shear_error *err) {
    /* A call that is not on the list fails, and the library reports that like any other failure. */
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    const int rc = filter != NULL ? load(filter) : -ENOMEM;
    if (filter != NULL)
        seccomp_release(filter);
    errno = -rc;
    return rc == 0 ? SHEAR_OK : fail_errno(err, "seccomp");
}

int sandbox_enter(const sandbox_limits *limits, unsigned *guards, shear_error *err) {
    TRY(set_limits(limits, err));
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_PDEATHSIG, 9, 0, 0, 0) != 0)
        return fail_errno(err, "no new privileges");
    if (prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) != 0)
        return fail_errno(err, "not dumpable");
    TRY(enter_landlock(guards, err));
    int code = enter_seccomp(err);
    *guards |= code == SHEAR_OK ? SANDBOX_SECCOMP | SANDBOX_UNDUMPABLE : 0U;
    return code;
}
