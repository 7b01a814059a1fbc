# closed.sh JOB HERE HIDDEN... : COMMAND...
#
# Runs COMMAND in the folder JOB/code without network, with process numbers of its own, and with mounts that nobody else has: JOB is seen
# as HERE, nothing else can be written, and the hidden folders are seen empty. What it has started ends with it.
set -e
if [ "$1" != inside ]; then
  exec unshare --user --map-root-user --net --pid --fork --kill-child --mount sh "$0" inside "$@"
fi
here=$3
mount --bind "$2" "$here"
while read -r _ _ _ _ place _; do
  case $place in
    # The namespaces' own settings are written below /proc.
    "$here" | /proc | /proc/*) ;;
    *) mount -o remount,bind,ro "$place" 2> /dev/null || true ;;
  esac
done < /proc/self/mountinfo
cd "$here/code"
shift 3
while [ "$1" != : ]; do
  mount -t tmpfs -o size=1m,mode=755 tmpfs "$1"
  shift
done
shift
[ ! -d /dev/shm ] || mount -t tmpfs -o size=64m tmpfs /dev/shm
# One more namespace for users, in which nothing of that can be undone.
exec unshare --user --map-root-user "$@"
