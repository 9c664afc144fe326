#!/usr/bin/env bash
# `fascia batch submit` on a Slurm cluster of two nodes that live on this machine's loopback: one node is killed, one head
# is none, one needs more memory than it may use; every good head is built exactly once. Needs root, slurmctld, slurmd,
# slurm-client and munge; leaves with 77 where they are not there.
#   slurm_test.sh FASCIA HEAD.obj LANDMARKS.json
set -euo pipefail
tool=$1 head=$(realpath "$2") landmarks=$(realpath "$3")
for program in slurmctld slurmd sbatch munged runuser; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: needs root"; exit 77; }
export PATH=$PATH:/usr/sbin
place=$(mktemp -d)
chmod 755 "$place"
host=$(hostname -s)
own=()  # processes of this test
stop() {
  for process in "${own[@]}"; do kill "$process" 2>/dev/null || true; done
  for node in n1 n2; do [ ! -e "$place/slurmd.$node.pid" ] || kill "$(cat "$place/slurmd.$node.pid")" 2>/dev/null || true; done
  [ ! -e "$place/slurmctld.pid" ] || kill "$(cat "$place/slurmctld.pid")" 2>/dev/null || true
  sleep 1
  rm -rf "$place"
}
trap stop EXIT

install -d -o munge -g munge -m 0755 /run/munge "$place/munge"
runuser -u munge -- munged --foreground --force --socket="$place/munge/socket" --pid-file="$place/munge/pid" \
  --log-file="$place/munge/log" --seed-file="$place/munge/seed" &
own+=($!)
install -d -o slurm -g slurm "$place/state"
install -d "$place/n1" "$place/n2"
export SLURM_CONF=$place/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=fascia
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmUser=slurm
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$place/munge/socket,cred_expire=5
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/%n
SlurmdPidFile=$place/slurmd.%n.pid
SlurmctldPidFile=$place/slurmctld.pid
SlurmctldLogFile=$place/state/log
SlurmdLogFile=$place/%n/log
SlurmdTimeout=10
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2
ReturnToService=2
SlurmdParameters=config_overrides
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=17001 CPUs=1 RealMemory=8000 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=17002 CPUs=1 RealMemory=8000 State=UNKNOWN
PartitionName=build Nodes=n1,n2 Default=YES MaxTime=01:00:00 State=UP
CONF
touch "$place/slurmctld.pid" && chown slurm "$place/slurmctld.pid"
sleep 1
runuser -u slurm -- env SLURM_CONF="$SLURM_CONF" slurmctld -c -i
slurmd -N n1
slurmd -N n2
for _ in $(seq 60); do [ "$(sinfo -h -t idle -N 2>/dev/null | wc -l)" = 2 ] && break; sleep 1; done
sinfo -N

# Six good heads, one that is no mesh, and one that is far larger than the memory it may use (a sparse file).
mkdir "$place/heads" "$place/out"
for k in 1 2 3 4 5 6; do
  mkdir "$place/heads/$k"  # of one name, for a rig bears it
  cp "$head" "$place/heads/$k/head.obj"
  echo "{\"head\": \"heads/$k/head.obj\", \"landmarks\": \"$landmarks\", \"detail\": \"low\", \"id\": \"good$k\"}"
done >"$place/heads.jsonl"
echo "no mesh" >"$place/heads/poisoned.obj"
truncate -s 2G "$place/heads/large.stl"
printf '\377\377\177\002' | dd of="$place/heads/large.stl" bs=1 seek=80 conv=notrunc status=none
printf '{"head": "heads/poisoned.obj", "id": "poisoned"}\n{"head": "heads/large.stl", "id": "large"}\n' >>"$place/heads.jsonl"

"$tool" batch submit "$place/heads.jsonl" -o "$place/out" --task-count 4 --jobs 1 --memory 1500 --no-thumbnail
# Processes on a node, by the variable that Slurm gives them, and the first of them that builds a head.
on_node() { { grep -lzx "SLURMD_NODENAME=$1" /proc/[0-9]*/environ 2>/dev/null || true; } | cut -d/ -f3; }  # some end meanwhile
builder_on() { for process in $(on_node "$1"); do ! grep -qz '^build$' "/proc/$process/cmdline" 2>/dev/null || { echo "$process"; return; }; done; }
for _ in $(seq 600); do [ -n "$(builder_on n2)" ] && break; sleep 0.1; done
[ -n "$(builder_on n2)" ] || { echo "no head was in work on the node that is to be killed"; squeue; sinfo -N; exit 1; }
# The node is gone with all that runs there, in the middle of a head; its task is queued again.
kill -9 "$(cat "$place/slurmd.n2.pid")"
there=$(on_node n2)
for process in $there; do
  parent=$(ps -o ppid= -p "$process" | tr -d ' ')
  [ "$(cat "/proc/$parent/comm" 2>/dev/null)" != slurmstepd ] || kill -9 "$parent"
done
for process in $there; do kill -9 "$process" 2>/dev/null || true; done
for _ in $(seq 600); do [ -z "$(squeue -h)" ] && break; sleep 1; done
[ -z "$(squeue -h)" ] || { echo "the queue never emptied"; squeue; exit 1; }

grep -qi requeu "$place/state/log" || { echo "the killed node's task was not queued again"; tail "$place/state/log"; exit 1; }

# Every process says in its task's log what it built: "[1/2] good1: 2.3 s".
for k in 1 2 3 4 5 6; do
  builds=$(cat "$place"/out/.logs/*.txt | grep -cE "\] good$k: [0-9.]+ s" || true)
  [ "$builds" = 1 ] || { echo "good$k was built $builds times"; grep . "$place"/out/.logs/*.txt; exit 1; }
done

# The same again finds nothing to do: every head that can be built has been.
"$tool" batch "$place/heads.jsonl" -o "$place/out" --memory 1500 --no-thumbnail --json >"$place/again.json" || [ $? = 1 ]
cat "$place/again.json"
grep -q '"built": 0' "$place/again.json"
grep -q '"failed": 2' "$place/again.json"
for k in 1 2 3 4 5 6; do
  "$tool" info "$place/out/good$k/rig.glb" --validate --quiet
  cmp "$place/out/good1/rig.glb" "$place/out/good$k/rig.glb"
done
grep -q 'limit of memory' "$place/out/large/job.json"
grep -q 'poisoned' "$place/out/poisoned/job.json"
[ ! -e "$place/out/large/rig.glb" ] && [ ! -e "$place/out/poisoned/rig.glb" ]
[ -z "$(ls "$place/out/.work")" ]
"$tool" batch report "$place/out"
echo "six of six good heads, each once"
