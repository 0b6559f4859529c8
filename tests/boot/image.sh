# SPDX-License-Identifier: GPL-3.0-or-later
# Part of boot-test: the root file system, in the working directory.

# Where this machine has its packages from, as arguments of mmdebstrap.
mirrors() {
    local file
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
        [ ! -s "$file" ] || echo "$file"
    done
}

# A service of the machine that runs the payload's checks once it is up, on the serial line.
add_checks() {
    cat >root/etc/systemd/system/checks.service <<'UNIT'
[Unit]
After=multi-user.target
[Service]
Type=idle
ExecStart=/bin/sh -c 'mkdir -p /payload; mount /dev/vdb /payload; exec /bin/bash /payload/checks'
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS0
UNIT
    ln -s ../checks.service root/etc/systemd/system/multi-user.target.wants/
}

# make_root DEB: all that the package depends on, but the package, in root/; with kernel and initrd beside it.
make_root() {
    local depends packages
    depends=$(dpkg-deb -f "$1" Depends | sed 's/([^)]*)//g; s/|[^,]*//g; s/ //g')
    packages=systemd-sysv,dbus,udev,linux-image-cloud-amd64,initramfs-tools,procps,libinih1,$depends # 0.1 needs libinih
    [ "$(cat packages 2>/dev/null)" != "$packages" ] || return 0
    rm -rf root packages
    apt-config dump | grep '^Acquire::.*[Pp]roxy' >apt.conf || true
    # shellcheck disable=SC2046 # one file a word
    mmdebstrap --mode=root --variant=minbase --aptopt=apt.conf --include="$packages" bookworm root $(mirrors) >mmdebstrap.log 2>&1 ||
        { tail -5 mmdebstrap.log >&2; exit 2; }
    echo "/dev/vda / ext4 defaults 0 1" >root/etc/fstab
    ln -sf /dev/null root/etc/systemd/system/serial-getty@ttyS0.service
    add_checks
    cp root/boot/vmlinuz-* kernel
    cp root/boot/initrd.img-* initrd
    echo "$packages" >packages
}

# make_disk FILE DIRECTORY MEGABYTES
make_disk() {
    rm -f "$1"
    mke2fs -q -t ext4 -d "$2" "$1" "$3M" >/dev/null
}
