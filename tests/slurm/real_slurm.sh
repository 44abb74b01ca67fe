#!/usr/bin/env bash
# Slurm itself on this machine: real_slurm.sh SLIPMODE SCENE. Starts Munge, a controller and a node on
# loopback in a folder of their own, submits what `sweep --slurm` writes, warns a task that has begun as Slurm does before
# a limit, and compares the merged result with that of one process. Stops everything it started.
# Exit code 0: the same bytes; 77: Slurm cannot run here, and why; else what went wrong.
set -euo pipefail
slipmode=$1 scene=$2

skip() {
  echo "no Slurm here: $1" >&2
  exit 77
}
PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sinfo sbatch squeue scancel scontrol; do
  command -v $program >/dev/null || skip "$program is not installed (Debian: slurm-wlm, munge)"
done
[[ $(id -u) -eq 0 ]] || skip "its daemons are started as root"

folder=$(mktemp -d /tmp/slurm_XXXXXX)
export SLURM_CONF=$folder/slurm.conf
daemons=()
finish() {
  kill "${daemons[@]}" 2>/dev/null || true
  wait
  rm -rf "$folder"
}
trap finish EXIT

port=$(shuf -i 20000-30000 -n 1)
chmod 755 "$folder"
mkdir -m 755 "$folder"/{munge,state,spool,jobs}
head -c 1024 /dev/urandom >"$folder/munge/key"
chmod 600 "$folder/munge/key"
cat >"$SLURM_CONF" <<END
ClusterName=loopback
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MailProg=/bin/true
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(free -m | awk "/^Mem/ {print \$2}") State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END

munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" \
  --pid-file="$folder/munge/pid" --log-file="$folder/munge/log" --seed-file="$folder/munge/seed" &>/dev/null &
daemons+=($!)
slurmctld -D -i -L "$folder/slurmctld.log" &>/dev/null &
daemons+=($!)
slurmd -D -L "$folder/slurmd.log" &>/dev/null &
daemons+=($!)

# until_true SECONDS COMMAND
until_true() {
  local end=$((SECONDS + $1))
  shift
  until "$@"; do
    [[ $SECONDS -lt $end ]] || return 1
    sleep 0.2
  done
}
idle() { [[ $(sinfo --noheader --format=%T 2>/dev/null) == idle ]]; }
until_true 30 idle || skip "no node after 30 s: $(tail -n 2 "$folder/slurmctld.log" "$folder/slurmd.log" 2>&1)"

cd "$folder/jobs"
timeout 60 sbatch --quiet --wait --output=/dev/null --wrap=true ||
  skip "a job that does nothing does not end well in a minute"
cp "$scene" scene.toml
sweep=("$slipmode" sweep scene.toml --over drive.speed=0.5:0.02:0.0004 --threads 1)
"${sweep[@]}" -o one.h5 --quiet
"${sweep[@]}" -o all.h5 --slurm scripts --shards 3 --quiet
bash scripts/submit.sh >submitted

first_shard_has_values() { grep -qs sweep-0 scripts/1.part.journal; }
until_true 60 first_shard_has_values || { squeue; echo "the first shard did not begin" >&2; exit 1; }
array=$(squeue --noheader --array --format=%F | head -n 1)
scancel --signal=USR1 --batch "${array}_1"

# A job that is put in the queue again waits for two minutes, which nothing here needs.
queue_is_empty() {
  local waiting
  for waiting in $(squeue --noheader --array --states=PENDING --format=%F_%K); do
    scontrol update job="$waiting" StartTime=now 2>/dev/null || true
  done
  [[ -z $(squeue --noheader) ]]
}
until_true 300 queue_is_empty || { squeue; echo "jobs are left" >&2; exit 1; }
cmp one.h5 all.h5 || { cat submitted ./*.out scripts/*.out 2>/dev/null >&2; exit 1; }
requeued=$(grep -c 'Requeu\|requeue' "$folder/slurmctld.log" || true)
echo "the same bytes from three tasks, put in the queue again $requeued times"
[[ $requeued -gt 0 ]] || { echo "the warned task was not put in the queue again" >&2; exit 1; }
