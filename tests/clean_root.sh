#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The proof that a Debian with nothing on it suffices: clean roots are made by mmdebstrap, the README's two commands run
# in one, in both orders, and the Debian packages are installed by dpkg in others, where a program is built on them and
# Python imports them, with static and with shared libraries. By hand and in the nightly run, because it takes hours.
#
#   sh tests/clean_root.sh [--suite SUITE]            all of it; SUITE: bookworm (Debian 12, the default) or trixie (13)
#   sh tests/clean_root.sh [--suite SUITE] readme     the README's two commands in both orders, on what is committed
#   sh tests/clean_root.sh packages BUILD_FOLDER...   the packages of trees that are built here, on this machine's Debian
#   sh tests/clean_root.sh [--suite SUITE] arm64 [CTEST_OPTION...]
#                                                     cross-compiles for aarch64 against the libraries of a root of
#                                                     arm64, and runs the quick tests, or those of CTEST_OPTION..., under
#                                                     qemu; `arm64 root` makes the root alone, for your own build
#
# Runs as root. `sh cmake/install_dependencies.sh --clean-root` installs mmdebstrap, and `--arm64` also the cross compiler
# and qemu. Variables:
#   HOLDFAST_MIRROR      http://deb.debian.org/debian by default
#   HOLDFAST_CLEAN_ROOT  folder for the roots, 15 GB for all of it; one that is kept makes the next time quicker. Not
#                        set: a folder below /tmp, which is removed at the end
#   HOLDFAST_CCACHE      a ccache folder to lend to the builds, for trials of this script
#   HOLDFAST_ARM64_BUILD build folder of arm64; build-arm64 by default. An earlier build there is continued
set -eu

cd "$(dirname "$0")/.."
source=$PWD
suite=bookworm
if [ "${1:-}" = --suite ]; then
  suite=${2:-}
  case "$suite" in
    bookworm | trixie) shift 2 ;;
    *) echo "clean_root: unknown suite '$suite'; expected bookworm or trixie" >&2; exit 2 ;;
  esac
fi
mirror=${HOLDFAST_MIRROR:-http://deb.debian.org/debian}
say() { printf 'clean_root: %s\n' "$*"; }
fail() { say "$@" >&2; exit 1; }

case "${1:-all}" in
  all | readme) part=${1:-all} ;;
  packages)
    part=packages
    shift
    [ $# -gt 0 ] || fail "packages of which build folder? expected sh tests/clean_root.sh packages BUILD_FOLDER..."
    suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
    ;;
  arm64) part=arm64; shift ;;
  -h | --help) sed -n '3,24s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) fail "unknown argument '$1'; expected [--suite SUITE], then readme, packages BUILD_FOLDER..., arm64, or nothing" ;;
esac
[ "$(id -u)" -eq 0 ] || fail "needs root: roots have owners, and chroot is root's"
command -v mmdebstrap > /dev/null ||
  fail "mmdebstrap is missing; \`sh cmake/install_dependencies.sh --clean-root\` installs it"

if [ -n "${HOLDFAST_CLEAN_ROOT:-}" ]; then
  roots=$HOLDFAST_CLEAN_ROOT
  mkdir -p "$roots"
  is_kept=yes
else
  roots=$(mktemp -d)
  is_kept=no
fi
release() {  # ROOT: nothing of this machine is in it any more
  for place in ccache dev/pts dev/shm proc; do
    if mountpoint -q "$1/$place"; then umount "$1/$place"; fi
  done
}
registered=no
clean_up() {
  if [ "$registered" = yes ]; then echo -1 > "$binfmt/qemu-aarch64"; fi
  for each in "$roots"/*/; do release "${each%/}"; done
  # A root that could not be released still shows this machine's files: --one-file-system leaves those alone.
  [ "$is_kept" = yes ] || rm -rf --one-file-system "$roots"
}
trap clean_up EXIT

# make_root NAME: a root with the packages that Debian calls required, and apt.
make_root() {
  if [ ! -f "$roots/base-$suite.tar" ]; then
    say "asking $mirror for a clean $suite"
    mmdebstrap --quiet --format=tar --variant=minbase --include=ca-certificates "$suite" "$roots/base-$suite.tar.part" "$mirror"
    mv "$roots/base-$suite.tar.part" "$roots/base-$suite.tar"
  fi
  release "$roots/$1"
  rm -rf --one-file-system "${roots:?}/$1"
  mkdir "$roots/$1"
  tar -xf "$roots/base-$suite.tar" -C "$roots/$1"
  cp /etc/resolv.conf "$roots/$1/etc/resolv.conf"
  mount -t proc proc "$roots/$1/proc"
  mkdir -p "$roots/$1/dev/shm" "$roots/$1/dev/pts"
  mount -t tmpfs tmpfs "$roots/$1/dev/shm"
  mount -t devpts -o mode=620,ptmxmode=666 devpts "$roots/$1/dev/pts"
  if [ -n "${HOLDFAST_CCACHE:-}" ]; then
    mkdir -p "$roots/$1/ccache"
    mount --bind "$HOLDFAST_CCACHE" "$roots/$1/ccache"
  fi
}

# inside NAME COMMAND: a shell of the root, with nothing of our environment.
inside() {
  cache=""
  if [ -n "${HOLDFAST_CCACHE:-}" ]; then cache="CCACHE_DIR=/ccache"; fi
  env -i HOME=/root LANG=C.UTF-8 TERM=dumb DEBIAN_FRONTEND=noninteractive $cache \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin chroot "$roots/$1" /bin/sh -euc "$2"
}

# The README's two commands on a clone of what is committed, one after the other; then again in the other order, in a
# root and a clone of their own. The second root is left for the packages.
try_readme() {
  for order in "demo test" "test demo"; do
    make_root readme
    git clone --quiet "$source" "$roots/readme/root/holdfast"
    for command in $order; do
      say "$suite: sh cmake/$command.sh"
      inside readme "cd /root/holdfast && sh cmake/$command.sh"
      [ "$command" != demo ] || inside readme "test -s /root/holdfast/out/demo/report.html"
    done
  done
  say "$suite: the README's two commands work in a clean root, in both orders"
}

# pack NAME BUILD_FOLDER: the packages of a tree into $roots/NAME.
pack() {
  rm -rf "${roots:?}/$1"
  mkdir "$roots/$1"
  cpack -G DEB -B "$roots/$1" --config "$2/CPackConfig.cmake" > "$roots/$1.log" 2>&1 ||
    { cat "$roots/$1.log" >&2; fail "cpack of $2 failed"; }
}

# install_packages EXTRA...: those in /packages of the root `target`, by dpkg; before, what they need from the mirror, and
# EXTRA.
install_packages() {
  needed=$(for file in "$roots/target/packages"/*.deb; do dpkg-deb --field "$file" Depends | tr ',' '\n'; done |
    sed 's/^ *//; /^libholdfast/d; /^holdfast/d; /^$/d' | sort -u | paste -s -d , -)
  for extra in "$@"; do needed="$needed,$extra"; done
  inside target "apt-get -qq satisfy --yes --no-install-recommends '$needed' > /log 2>&1 || { cat /log; exit 1; }
    dpkg --install /packages/*.deb
    test -z \"\$(dpkg --audit)\""
}

# try_packages FOLDER: of $roots/FOLDER, in a root of their own.
try_packages() {
  ls "$roots/$1"/*.deb > /dev/null || fail "$roots/$1 holds no packages"
  make_root target
  mkdir "$roots/target/packages"
  inside target "apt-get -qq update"
  # First what users of the program and of Python install.
  cp "$roots/$1"/*.deb "$roots/target/packages"
  rm "$roots/target/packages"/libholdfast-dev_*.deb
  say "$1: the program and the Python package"
  install_packages
  inside target "holdfast run /usr/share/holdfast/configs/demo.yaml --set source.simulated.duration=1 \
      --output /tmp/out --quiet
    test -s /tmp/out/report.html"
  cat > "$roots/target/tmp/use.py" << 'END'
import holdfast
result = holdfast.run("/usr/share/holdfast/configs/demo.yaml", {"source.simulated.duration": 1}, progress=False)
assert result.trajectory.to_text() == open("/tmp/out/trajectory.txt").read(), "the bytes of the program"
print(result)
END
  inside target "python3 /tmp/use.py && python3 -m holdfast --version"
  # Then what a program that is built on the library needs.
  say "$1: a program on libholdfast-dev"
  cp "$roots/$1"/libholdfast-dev_*.deb "$roots/target/packages"
  install_packages cmake g++ make
  mkdir "$roots/target/consumers"
  for each in embedded installed plugin whole; do cp -R "tests/consumers/$each" "$roots/target/consumers"; done
  inside target "cd /consumers
    for each in installed plugin whole; do
      { cmake -S \$each -B build_\$each && cmake --build build_\$each; } > /log 2>&1 || { cat /log; exit 1; }
    done
    build_installed/consumer && build_installed/geometry_consumer
    HOLDFAST_PLUGIN_PATH=/consumers/build_plugin holdfast run plugin/run.yaml --output /tmp/plugin --quiet
    build_whole/consumer whole/simulated.yaml > /dev/null"
  # And away again, without a trace.
  inside target "dpkg --purge \$(dpkg-query --show --showformat='\${Package}\\n' '*holdfast*') > /dev/null
    test -z \"\$(find /usr /etc -name '*holdfast*')\""
  release "$roots/target"
  say "$1: the packages work in a clean root"
}

# make_arm64_root FOLDER: the libraries that Holdfast is built on, for arm64. Packages are unpacked by this machine's dpkg and
# not configured, which would need hours under qemu; what configuring would have done for us follows.
make_arm64_root() {
  libraries=$(sh cmake/install_dependencies.sh --surface --list | tr ' ' '\n' | grep -- '-dev$' | paste -s -d , -)
  say "asking $mirror for the libraries of $suite for arm64"
  rm -rf "$1.part"
  mmdebstrap --quiet --architectures=arm64 --variant=extract --include="$libraries" "$suite" "$1.part" "$mirror"
  # The linker takes absolute links to be this machine's.
  find "$1.part" -type l -lname '/*' | while read -r link; do
    ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$1.part$(readlink "$link")")" "$link"
  done
  # The packages of Ceres, FLANN and Assimp name libraries by absolute paths; the prefix of a CMake package is the root's.
  grep -rl 'LIBRARIES.*[;":]/usr/lib/aarch64-linux-gnu/' --include='*.cmake' "$1.part/usr/lib" |
    xargs sed -i '/LIBRARIES/s|\([;":]\)/usr/lib/aarch64-linux-gnu/|\1${_IMPORT_PREFIX}/lib/aarch64-linux-gnu/|g'
  libraries=$1.part/usr/lib/aarch64-linux-gnu
  # Draco's, for which Assimp asks, has an absolute prefix.
  sed -i -e 's|PREFIX "/usr"|PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../../.."|' -e 's|"/usr/lib/|"${_IMPORT_PREFIX}/lib/|' \
    "$libraries"/cmake/draco/draco-targets*.cmake
  for name in libblas liblapack; do
    for folder in ${name#lib} atlas; do  # the one that Debian's alternatives prefer last
      for file in $name.so.3 $name.so; do
        [ ! -e "$libraries/$folder/$file" ] || ln -sf "$folder/$file" "$libraries/$file"
      done
    done
  done
  mv "$1.part" "$1"
}

# Programs for aarch64 run as if they were this machine's: tests start the program `holdfast` by themselves.
binfmt=/proc/sys/fs/binfmt_misc
register_qemu() {
  [ -e "$binfmt/register" ] || mount -t binfmt_misc binfmt_misc "$binfmt" ||
    fail "this kernel has no binfmt_misc, by which the system runs programs of another processor"
  [ ! -e "$binfmt/qemu-aarch64" ] || return 0
  cat /usr/lib/binfmt.d/qemu-aarch64.conf > "$binfmt/register" || fail "qemu could not be registered in $binfmt"
  registered=yes
}

try_arm64() {
  for program in aarch64-linux-gnu-g++ qemu-aarch64-static; do
    command -v "$program" > /dev/null ||
      fail "$program is missing; \`sh cmake/install_dependencies.sh --arm64\` installs it"
  done
  [ "${1:-}" != root ] || [ "$is_kept" = yes ] || fail "where is the root to be? expected the variable HOLDFAST_CLEAN_ROOT"
  root=$roots/arm64-$suite
  [ -d "$root" ] || make_arm64_root "$root"
  [ "${1:-}" != root ] || return 0
  build=${HOLDFAST_ARM64_BUILD:-build-arm64}
  cmake --preset release -B "$build" -DCMAKE_TOOLCHAIN_FILE="$source/cmake/toolchains/aarch64-linux-gnu.cmake" \
    -DCMAKE_SYSROOT="$root" -DHOLDFAST_UNITY=ON -DHOLDFAST_BUILD_EXAMPLES=OFF -DHOLDFAST_INSTALL=OFF
  cmake --build "$build" --parallel "$(nproc)"
  register_qemu
  [ $# -gt 0 ] || set -- --label-regex '^quick$'
  # OpenCV's video files are GStreamer's, which starts a program of its own that it knows by its absolute path.
  QEMU_LD_PREFIX=$root GST_PLUGIN_SCANNER=$root/usr/lib/aarch64-linux-gnu/gstreamer1.0/gstreamer-1.0/gst-plugin-scanner \
    ctest --test-dir "$build" --parallel "$(nproc)" --output-on-failure --no-tests=error \
    --output-log "$build/tests_arm64.log" --timeout 3000 "$@"
}

case "$part" in
  arm64) try_arm64 "$@" ;;
  packages)
    number=0
    for build in "$@"; do
      number=$((number + 1))
      pack "packages_$number" "$build"
      try_packages "packages_$number"
    done
    ;;
  readme) try_readme ;;
  all)
    try_readme
    for kind in static shared; do
      build=/root/holdfast/build
      if [ "$kind" = shared ]; then
        build=/root/holdfast/build-shared
        inside readme "cd /root/holdfast
          cmake --preset release -B $build -DBUILD_SHARED_LIBS=ON -DHOLDFAST_UNITY=ON -DHOLDFAST_BUILD_TESTS=OFF \
            -DHOLDFAST_BUILD_EXAMPLES=OFF -DHOLDFAST_PYTHON=ON -DHOLDFAST_PYTHON_PACKAGE=ON
          cmake --build $build --parallel $(nproc)"
      fi
      inside readme "cd /root && rm -rf $kind && cpack -G DEB -B $kind --config $build/CPackConfig.cmake > /dev/null"
      rm -rf "${roots:?}/packages_$kind"
      cp -R "$roots/readme/root/$kind" "$roots/packages_$kind"
      try_packages "packages_$kind"
    done
    ;;
esac
say "everything passed"
