/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What code that has taken over a reader can still do: it tries everything that once got out of
 * the sandbox, and more. The victim stands for the service: another process of the same user.
 * Each attempt is proved to work outside the sandbox, where it is harmless: an attempt that fails
 * everywhere proves nothing. */
#include "reader/sandbox.h"
#include "test.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/io_uring.h>
#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

/* What the attempts are made on. */
typedef struct scene {
    pid_t victim;
    int file;      /* open for reading */
    char path[64]; /* its name */
    long secret;   /* in the victim's memory, at the same address */
} scene;

typedef struct attempt {
    const char *what;
    long (*make)(const scene *s); /* -1: it failed */
    bool everywhere;              /* it fails outside too, for some or on some kernels */
} attempt;

/* ---- the victim's life ---- */

static long try_kill(const scene *s) {
    return syscall(SYS_kill, s->victim, 0);
}
static long try_tkill(const scene *s) {
    return syscall(SYS_tkill, s->victim, SIGCONT);
}
static long try_tgkill(const scene *s) {
    return syscall(SYS_tgkill, s->victim, s->victim, SIGCONT);
}
static long try_sigqueue(const scene *s) {
    siginfo_t info = {.si_code = SI_QUEUE};
    return syscall(SYS_rt_sigqueueinfo, s->victim, SIGCONT, &info);
}
static long try_pidfd(const scene *s) {
    return syscall(SYS_pidfd_open, s->victim, 0);
}
static long try_setown(const scene *s) {
    return syscall(SYS_fcntl, s->file, F_SETOWN, s->victim);
}
static long try_setsig(const scene *s) {
    return syscall(SYS_fcntl, s->file, F_SETSIG, SIGCONT);
}
static long try_setfl(const scene *s) {
    return syscall(SYS_fcntl, s->file, F_SETFL, O_NONBLOCK);
}
static long try_prlimit_set(const scene *s) {
    const struct rlimit same = {RLIM_INFINITY, RLIM_INFINITY};
    return syscall(SYS_prlimit64, s->victim, RLIMIT_CPU, &same, NULL);
}
static long try_prlimit_get(const scene *s) {
    struct rlimit got;
    return syscall(SYS_prlimit64, s->victim, RLIMIT_CPU, NULL, &got);
}
static long try_own_limits(const scene *s) {
    (void)s;
    const struct rlimit none = {0, RLIM_INFINITY};
    return syscall(SYS_prlimit64, 0, RLIMIT_CORE, &none, NULL);
}
static long try_priority(const scene *s) {
    return syscall(SYS_setpriority, PRIO_PROCESS, s->victim, 1);
}
static long try_ioprio(const scene *s) {
    return syscall(SYS_ioprio_set, 1, s->victim, 2 << 13 | 4);
}
static long try_set_affinity(const scene *s) {
    cpu_set_t set;
    sched_getaffinity(getppid(), sizeof set, &set);
    CPU_ZERO(&set);
    CPU_SET(0, &set);
    return syscall(SYS_sched_setaffinity, s->victim, sizeof set, &set);
}
static long try_get_affinity(const scene *s) {
    cpu_set_t set;
    return syscall(SYS_sched_getaffinity, s->victim, sizeof set, &set);
}
static long try_scheduler(const scene *s) {
    const struct sched_param p = {0};
    return syscall(SYS_sched_setscheduler, s->victim, SCHED_BATCH, &p);
}

/* ---- its memory ---- */

static long try_ptrace(const scene *s) {
    return syscall(SYS_ptrace, PTRACE_SEIZE, s->victim, 0, 0);
}
static long try_vm_read(const scene *s) {
    long got = 0;
    const struct iovec to = {&got, sizeof got};
    const struct iovec from = {(void *)&s->secret, sizeof got};
    return syscall(SYS_process_vm_readv, s->victim, &to, 1, &from, 1, 0);
}
static long try_vm_write(const scene *s) {
    long value = s->secret;
    const struct iovec from = {&value, sizeof value};
    const struct iovec to = {(void *)&s->secret, sizeof value};
    return syscall(SYS_process_vm_writev, s->victim, &from, 1, &to, 1, 0);
}
static long try_proc_mem(const scene *s) {
    char path[40];
    snprintf(path, sizeof path, "/proc/%d/mem", (int)s->victim);
    return open(path, O_RDWR);
}

/* ---- files ---- */

static long try_open(const scene *s) {
    return open(s->path, O_RDONLY);
}
static long try_open_passwd(const scene *s) {
    (void)s;
    return open("/etc/passwd", O_RDONLY);
}
static long try_open_path(const scene *s) {
    (void)s;
    return open("/etc/passwd", O_PATH);
}
static long try_old_open(const scene *s) {
    return syscall(SYS_open, s->path, O_RDONLY, 0);
}
static long try_openat2(const scene *s) {
    struct {
        uint64_t flags, mode, resolve;
    } how = {0};
    return syscall(SYS_openat2, AT_FDCWD, s->path, &how, sizeof how);
}
static long try_open_again(const scene *s) {
    char path[40];
    snprintf(path, sizeof path, "/proc/self/fd/%d", s->file);
    return open(path, O_RDONLY);
}
static long try_temporary(const scene *s) {
    (void)s;
    return open("/tmp", O_TMPFILE | O_RDWR, 0600);
}
static long try_stat(const scene *s) {
    struct stat st;
    return syscall(SYS_stat, s->path, &st);
}
static long try_newfstatat(const scene *s) {
    struct stat st;
    return syscall(SYS_newfstatat, AT_FDCWD, "/etc/passwd", &st, 0) + 0 * s->file;
}
static long try_empty_path(const scene *s) {
    struct stat st;
    (void)s;
    return syscall(SYS_newfstatat, AT_FDCWD, "/etc/passwd", &st, AT_EMPTY_PATH);
}
static long try_statx(const scene *s) {
    struct statx st;
    (void)s;
    return syscall(SYS_statx, AT_FDCWD, "/etc/passwd", 0, STATX_SIZE, &st);
}
static long try_access(const scene *s) {
    (void)s;
    return access("/etc/passwd", F_OK);
}
static long try_readlink(const scene *s) {
    char text[100];
    (void)s;
    return readlink("/proc/self/exe", text, sizeof text);
}
static long try_unlink(const scene *s) {
    char other[80];
    snprintf(other, sizeof other, "%s.link", s->path);
    return syscall(SYS_link, s->path, other) == 0 ? unlink(other) : -1;
}
static long try_chmod(const scene *s) {
    return chmod(s->path, 0600);
}
static long try_chdir(const scene *s) {
    (void)s;
    return chdir("/");
}
static long try_truncate_input(const scene *s) {
    return truncate(s->path, 10);
}

/* ---- the rest ---- */

static long try_socket(const scene *s) {
    (void)s;
    return socket(AF_UNIX, SOCK_STREAM, 0);
}
static long try_fork(const scene *s) {
    (void)s;
    const long pid = syscall(SYS_fork);
    if (pid == 0)
        _exit(0);
    return pid;
}
static long try_exec(const scene *s) {
    (void)s;
    char *const argv[] = {(char *)"true", NULL};
    return syscall(SYS_execve, "/bin/true", argv, argv); /* outside: this process ends with 0 */
}
static long try_memfd(const scene *s) {
    (void)s;
    return memfd_create("x", 0);
}
static long try_unshare(const scene *s) {
    (void)s;
    return unshare(CLONE_FILES);
}
static long try_ioctl(const scene *s) {
    int n = 0;
    return syscall(SYS_ioctl, s->file, 0x541B /* FIONREAD */, &n);
}
static long try_map_code(const scene *s) {
    (void)s;
    return mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED
               ? 0
               : -1;
}
static long try_map_file_as_code(const scene *s) {
    return mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE, s->file, 0) != MAP_FAILED ? 0 : -1;
}
static long try_make_code(const scene *s) {
    void *page = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    (void)s;
    return page != MAP_FAILED ? mprotect(page, 4096, PROT_READ | PROT_EXEC) : -1;
}
static long try_uring(const scene *s) {
    struct io_uring_params p = {0};
    (void)s;
    return syscall(SYS_io_uring_setup, 1, &p);
}
static long try_dumpable(const scene *s) {
    (void)s;
    return prctl(PR_SET_DUMPABLE, 1, 0, 0, 0);
}

static const attempt attempts[] = {
    {"kill", try_kill, false},
    {"tkill", try_tkill, false},
    {"tgkill", try_tgkill, false},
    {"rt_sigqueueinfo", try_sigqueue, false},
    {"pidfd_open", try_pidfd, true},
    {"fcntl F_SETOWN", try_setown, false},
    {"fcntl F_SETSIG", try_setsig, false},
    {"fcntl F_SETFL", try_setfl, false},
    {"prlimit64, setting the victim's", try_prlimit_set, false},
    {"prlimit64, reading the victim's", try_prlimit_get, false},
    {"prlimit64, raising its own", try_own_limits, true},
    {"setpriority", try_priority, false},
    {"ioprio_set", try_ioprio, true},
    {"sched_setaffinity", try_set_affinity, false},
    {"sched_getaffinity", try_get_affinity, false},
    {"sched_setscheduler", try_scheduler, false},
    {"ptrace", try_ptrace, true},
    {"process_vm_readv", try_vm_read, true},
    {"process_vm_writev", try_vm_write, true},
    {"/proc/PID/mem", try_proc_mem, true},
    {"open of the input by its name", try_open, false},
    {"open of /etc/passwd", try_open_passwd, false},
    {"open with O_PATH", try_open_path, false},
    {"the old open", try_old_open, false},
    {"openat2", try_openat2, true},
    {"open of what is open", try_open_again, false},
    {"open with O_TMPFILE", try_temporary, true},
    {"stat", try_stat, false},
    {"newfstatat", try_newfstatat, false},
    {"newfstatat with AT_EMPTY_PATH", try_empty_path, false},
    {"statx", try_statx, false},
    {"access", try_access, false},
    {"readlink", try_readlink, false},
    {"link and unlink", try_unlink, false},
    {"chmod", try_chmod, false},
    {"chdir", try_chdir, false},
    {"truncate", try_truncate_input, false},
    {"socket", try_socket, false},
    {"fork", try_fork, false},
    {"execve", try_exec, false},
    {"memfd_create", try_memfd, false},
    {"unshare", try_unshare, false},
    {"ioctl", try_ioctl, false},
    {"mmap of code", try_map_code, false},
    {"mmap of the input as code", try_map_file_as_code, true}, /* /tmp may be noexec */
    {"mprotect to code", try_make_code, false},
    {"io_uring_setup", try_uring, true},
    {"PR_SET_DUMPABLE", try_dumpable, false},
};
enum { N_ATTEMPTS = sizeof attempts / sizeof *attempts };

static bool own_namespaces; /* where they can be had */

static int enter(unsigned *guards) {
    if (own_namespaces)
        sandbox_unshare(guards);
    const sandbox_limits limits = {
        .memory_bytes = INT64_C(1) << 32, .cpu_seconds = 60, .file_bytes = 1 << 20};
    shear_error err = {0};
    if (sandbox_enter(&limits, guards, &err) != SHEAR_OK) {
        fprintf(stderr, "%s\n", err.message);
        return -1;
    }
    return 0;
}

/* In a process of its own: 0 it worked, 1 it failed, 2 there is no sandbox. */
static int outcome(const scene *s, const attempt *a, bool sandboxed) {
    int status = 0;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        unsigned guards = 0;
        if (sandboxed && enter(&guards) != 0)
            _exit(2);
        _exit(a->make(s) >= 0 ? 0 : 1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 3;
}

static pid_t start_victim(void) {
    const pid_t pid = fork();
    if (pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (;;)
            pause();
    }
    return pid;
}

static void try_all(void) {
    scene s = {.victim = start_victim(), .path = "/tmp/shear-sandbox-XXXXXX", .secret = 42};
    s.file = mkstemp(s.path);
    assert_true(s.file >= 0 && s.victim > 0);
    assert_int_equal(write(s.file, "some content", 12), 12);
    for (int i = 0; i < N_ATTEMPTS; i++) {
        const int outside = outcome(&s, &attempts[i], false);
        const int inside = outcome(&s, &attempts[i], true);
        if (inside != 1) {
            fail_msg("%s: %s", attempts[i].what,
                     inside == 0 ? "works in the sandbox" : "no sandbox");
        }
        if (outside != 0 && !attempts[i].everywhere)
            fail_msg("%s: fails outside the sandbox, so it proves nothing", attempts[i].what);
    }
    int status = 0;
    assert_int_equal(waitpid(s.victim, &status, WNOHANG), 0); /* it lives */
    kill(s.victim, SIGKILL);
    waitpid(s.victim, &status, 0);
    unlink(s.path);
    close(s.file);
}

static void test_attempts(void **state) {
    (void)state;
    own_namespaces = false;
    try_all();
}

static void test_attempts_in_namespaces(void **state) {
    (void)state;
    own_namespaces = true;
    try_all();
    own_namespaces = false;
}

/* In namespaces of its own there is nobody else, whatever calls are allowed. */
static void test_nobody_else(void **state) {
    (void)state;
    int status = 0;
    const pid_t victim = start_victim();
    const pid_t pid = fork();
    if (pid == 0) {
        unsigned guards = 0;
        sandbox_unshare(&guards);
        if ((guards & SANDBOX_NAMESPACES) == 0)
            _exit(77);
        _exit(getpid() == 1 && kill(victim, 0) != 0 && errno == ESRCH && getppid() == 0 ? 0 : 1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    kill(victim, SIGKILL);
    assert_int_equal(waitpid(victim, NULL, 0), victim);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
        skip();
    assert_int_equal(status, 0);
}

/* The one that waits ends as the other does. */
static void test_ends(void **state) {
    (void)state;
    for (int how = 0; how < 3; how++) {
        int status = 0;
        const pid_t pid = fork();
        if (pid == 0) {
            unsigned guards = 0;
            signal(SIGILL, SIG_DFL); /* cmocka's handler would run the other tests */
            signal(SIGTRAP, SIG_DFL);
            signal(SIGSEGV, SIG_DFL);
            sandbox_unshare(&guards);
            if (how == 0) {
                _exit(7);
            } else if (how == 1) {
                __builtin_trap();
            }
            abort();
        }
        assert_int_equal(waitpid(pid, &status, 0), pid);
        assert_true(how == 0 ? WIFEXITED(status) && WEXITSTATUS(status) == 7 : WIFSIGNALED(status));
    }
}

/* What it is for: reading what is open, writing scratch, taking memory, and talking. */
static int work(const int ends[2], int file) {
    char text[16] = "";
    struct stat st;
    unsigned guards = 0;
    if (enter(&guards) != 0)
        return 10;
    if ((guards & SANDBOX_SECCOMP) == 0 || (guards & SANDBOX_UNDUMPABLE) == 0)
        return 11;
    if (fstat(file, &st) != 0 || st.st_size != 5 || pread(file, text, 5, 0) != 5)
        return 12;
    char *memory = malloc(1 << 24);
    if (memory == NULL || memset(memory, 1, 1 << 24) == NULL)
        return 13;
    free(memory);
    if (pwrite(file, "more", 4, 5) != 4 || fcntl(file, F_DUPFD_CLOEXEC, 0) < 0)
        return 14;
    struct rlimit limit;
    if (getrlimit(RLIMIT_CORE, &limit) != 0 || limit.rlim_max != 0)
        return 15;
    return send(ends[1], text, 5, 0) == 5 ? 0 : 16;
}

static void test_work(void **state) {
    (void)state;
    char path[] = "/tmp/shear-sandbox-XXXXXX";
    char got[8] = "";
    int ends[2];
    int status = 0;
    const int file = mkstemp(path);
    unlink(path);
    assert_int_equal(write(file, "hello", 5), 5);
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends), 0);
    const pid_t pid = fork();
    if (pid == 0)
        _exit(work(ends, file));
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    assert_int_equal(recv(ends[0], got, sizeof got, 0), 5);
    assert_memory_equal(got, "hello", 5);
    close(ends[0]);
    close(ends[1]);
    close(file);
}

/* abort() still ends it by its signal: a crash is told as one. */
static void test_abort(void **state) {
    (void)state;
    int status = 0;
    const pid_t pid = fork();
    if (pid == 0) {
        unsigned guards = 0;
        if (enter(&guards) == 0)
            abort();
        _exit(2);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

static bool lower(int resource, rlim_t value) {
    const struct rlimit r = {.rlim_cur = value / 2, .rlim_max = value};
    return setrlimit((__rlimit_resource_t)resource, &r) == 0;
}

/* A service that may have less than its configuration says, and nobody's rights to raise that. */
static void test_lower_limits(void **state) {
    (void)state;
    int status = 0;
    const pid_t pid = fork();
    if (pid == 0) {
        unsigned guards = 0;
        struct rlimit r;
        if (!lower(RLIMIT_AS, 1 << 30) || !lower(RLIMIT_NOFILE, 32) ||
            (geteuid() == 0 && setuid(65534) != 0)) {
            _exit(3);
        }
        if (enter(&guards) != 0)
            _exit(2);
        _exit(getrlimit(RLIMIT_AS, &r) == 0 && r.rlim_cur == 1 << 30 ? 0 : 1);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_attempts),     cmocka_unit_test(test_attempts_in_namespaces),
        cmocka_unit_test(test_nobody_else),  cmocka_unit_test(test_ends),
        cmocka_unit_test(test_work),         cmocka_unit_test(test_abort),
        cmocka_unit_test(test_lower_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
