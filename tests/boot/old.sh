# SPDX-License-Identifier: GPL-3.0-or-later
# Part of boot-test: version 0.1 as it was, and what it left behind after 1,000 jobs: old/sheard.deb, old/state.tar,
# old/jobs.json, old/fields.json. Made from the history once; old/reason says why there is nothing.
old_commit=811792c
top=$here/../..

# Its package was right with this prefix only.
build_old() {
    rm -rf source build package && mkdir source &&
        git -C "$top" archive --format=tar $old_commit | tar -x -C source &&
        cmake -S source -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DCMAKE_INSTALL_PREFIX=/usr &&
        cmake --build build && (cd build && cpack -G DEB -B ../package) && cp package/*.deb sheard.deb
}

# A mount namespace of its own, so that 0.1 finds the paths that it will have in the machine.
old_jobs() {
    dpkg-deb -x sheard.deb program && unshare --mount --propagation private "$here/old-jobs" "$PWD/program" "$PWD"
}

make_old() {
    mkdir -p old
    [ ! -e old/state.tar ] || return 0
    if ! git -C "$top" cat-file -e "$old_commit^{tree}" 2>/dev/null; then
        echo "commit $old_commit is not in this clone's history" >old/reason
        return 0
    fi
    if ! (cd old && build_old && old_jobs) >old/log 2>&1; then
        tail -15 old/log >&2
        echo "boot-test: version 0.1 could not be made ($work/old/log)" >&2
        exit 2
    fi
    rm -rf old/source old/build old/package old/program
}
