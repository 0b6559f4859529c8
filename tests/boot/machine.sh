# SPDX-License-Identifier: GPL-3.0-or-later
# Part of boot-test: the machine itself, and what it said.

qemu=(qemu-system-x86_64 -machine q35 -smp 2 -m 1536 -nodefaults -nographic -serial stdio -kernel kernel)
declare -A cpu=([kvm]="max,arch-capabilities=off" [tcg]=max)

# Whether KVM starts a kernel: /dev/kvm may be there and not work. Without a root file system the kernel at least says its name,
# then it reboots, which ends qemu.
kvm_works() {
    { timeout 20 "${qemu[@]}" -accel kvm -cpu "${cpu[kvm]}" -no-reboot -append "console=ttyS0 panic=-1" </dev/null 2>&1 || true; } |
        grep -qa "Linux version"
}

run_machine() {
    if [ -z "${ACCEL:-}" ]; then
        ACCEL=tcg
        ! kvm_works || ACCEL=kvm
    fi
    # A new machine for each of the three boots: a reset ends qemu, and what was only in the machine's memory is gone.
    : >serial.log
    for _ in 1 2 3; do
        ! grep -qa "^CHECKS END" serial.log && [ $SECONDS -lt "$limit" ] || break
        timeout $((limit - SECONDS)) "${qemu[@]}" -accel "$ACCEL" -cpu "${cpu[$ACCEL]}" -no-reboot -initrd initrd \
            -append "root=/dev/vda console=ttyS0 quiet panic=-1" -drive file=disk.img,if=virtio,format=raw \
            -drive file=payload.img,if=virtio,format=raw </dev/null >>serial.log 2>&1 || break
    done
}

# The lines of the checks, then what is compared on this side, then the sum.
report() {
    local bad=0
    tr -d '\r' <serial.log | grep -a "^CHECK " >checks.log || true
    [ ! -e out/sheard.db ] || python3 -B "$here/compare.py" old out >>checks.log || true
    [ -e old/state.tar ] || echo "CHECK skip upgrade from 0.1: $(cat old/reason)" >>checks.log
    grep -qa "^CHECKS END" serial.log || echo "CHECK FAIL the machine did not come to its end within $limit s" >>checks.log
    cat checks.log
    bad=$(grep -c "^CHECK FAIL" checks.log || true)
    echo "$(grep -c "^CHECK ok" checks.log || true) ok, $bad failed, $SECONDS s ($ACCEL)"
    [ "$bad" = 0 ]
}
