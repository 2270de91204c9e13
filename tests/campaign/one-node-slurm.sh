#!/bin/sh
# Runs a campaign through a real Slurm of one node, kills the array in the middle, submits it again, and compares with the campaign run here.
#
#     tests/campaign/one-node-slurm.sh [COUNTERPOISE]
#
# Needs root, slurmctld, slurmd, sbatch and munged (Debian: apt install slurmctld slurmd slurm-client munge). Where they are not
# there, or cannot be started, it says so and ends well: exit code 0, with a line that begins with "skipped".
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
program=$(realpath "${1:-$root/target/release/counterpoise}")
shards=6

skip() { echo "skipped: $1"; exit 0; }
[ "$(id -u)" = 0 ] || skip "a one-node Slurm is started as root"
for tool in munged slurmctld slurmd sbatch squeue scancel; do
    command -v "$tool" >/dev/null || skip "$tool is not installed"
done
[ -x "$program" ] || skip "there is no $program: cargo build --release -p counterpoise"

work=$(mktemp -d)
pids=""
finish() {
    for pid in $pids; do kill "$pid" 2>/dev/null || true; done
    wait
    rm -rf "$work" || true
}
trap finish EXIT

start() { "$@" >>"$work/daemons.log" 2>&1 & pids="$pids $!"; }

if ! munge -n 2>/dev/null | unmunge >/dev/null 2>&1; then
    mkdir -p /run/munge && chown munge:munge /run/munge
    [ -f /etc/munge/munge.key ] || skip "there is no munge key"
    start setpriv --reuid=munge --regid=munge --clear-groups munged --foreground
    sleep 1
    munge -n 2>/dev/null | unmunge >/dev/null 2>&1 || skip "munged does not start"
fi

host=$(hostname -s)
export SLURM_CONF="$work/slurm.conf"
mkdir -p "$work/state" "$work/spool"
cat >"$SLURM_CONF" <<CONF
ClusterName=one
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=46817
SlurmdPort=46818
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
MinJobAge=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
start slurmctld -D -c -f "$SLURM_CONF"
start slurmd -D -N "$host" -f "$SLURM_CONF"
up=""
for _ in $(seq 30); do
    sleep 1
    if sinfo -h -o %T 2>/dev/null | grep -q '^idle'; then up=yes; break; fi
done
[ -n "$up" ] || { tail -n 5 "$work"/*.log; skip "the one-node Slurm does not come up"; }

# The example's design, with a campaign of some ten seconds: each shard lasts long enough to be killed inside.
mkdir "$work/project"
sed '/^\[verify\]/,$d' "$root/examples/reference-rig/project.toml" >"$work/project/project.toml"
cat >>"$work/project/project.toml" <<'TOML'
[verify]
duration = 10.0
settle = 2.0
[[verify.requirement]]
figure = "gain_margin_db"
at_least = 9.0
[[verify.requirement]]
figure = "nonlinear_both_compensated_hub_rms_rad_s"
at_most = 0.02
[sweep]
samples = 1800
seed = 5
[[sweep.variation]]
parameter = "hub_inertia"
low = 0.8
high = 1.25
[[sweep.variation]]
parameter = "friction"
distribution = "log-uniform"
low = 0.5
high = 2.0
TOML
judged() { code=0; "$@" || code=$?; [ "$code" -le 1 ] || { echo "failed ($code): $*"; exit 1; }; }
judged "$program" sweep "$work/project" -o "$work/here" --quiet >/dev/null

export COUNTERPOISE="$program"
cd "$work"
submit() { sbatch --parsable --array="0-$((shards - 1))" "$here/array.sbatch" "$work/project" "$work/there"; }
wait_for() { while squeue -h -j "$1" 2>/dev/null | grep -q .; do sleep 0.1; done; }
whole() { find "$work/there" -name 'shard-*.parquet' 2>/dev/null | wc -l; }
running() { squeue -h -r -t running -j "$1" -o %i 2>/dev/null | wc -l; }
# Inode, time and content of every whole shard: what is whole must not be written again.
marks() { find "$work/there" -name 'shard-*.parquet' -printf '%f %i %T@ ' -exec sha256sum {} \; 2>/dev/null | sort; }

# The kill comes where it hurts: some shards are whole, and a task is in the middle of another.
first=$(submit)
for _ in $(seq 1200); do
    { [ "$(whole)" -ge 2 ] && [ "$(running "$first")" -ge 1 ]; } && break
    sleep 0.05
done
sleep 0.3
struck=$(running "$first")
scancel --signal=KILL --full "$first"
scancel "$first" 2>/dev/null || true
wait_for "$first"
kept=$(whole)
marks >kept.txt
echo "killed: job array $first, $struck running, $kept of $shards shards whole"
[ "$struck" -ge 1 ] || { echo "failed: no task was running when the kill came"; exit 1; }
[ "$kept" -ge 1 ] && [ "$kept" -lt "$shards" ] || { echo "failed: the kill left $kept of $shards shards whole"; exit 1; }
"$program" sweep "$work/project" -o "$work/there" --merge --quiet >/dev/null 2>merge.txt && code=0 || code=$?
[ "$code" = 2 ] || { echo "failed: a merge of $kept of $shards shards ended with $code"; exit 1; }
echo "merge before the rest: refused:"; sed 's/^/    /' merge.txt

second=$(submit)
wait_for "$second"
again=$(whole)
echo "run again: job array $second, $again of $shards shards are whole"
[ "$again" = "$shards" ] || { cat slurm-*.out; echo "failed: $again of $shards shards"; exit 1; }
marks >all.txt
[ "$(comm -12 kept.txt all.txt | wc -l)" = "$kept" ] || { echo "failed: a whole shard was written again"; exit 1; }

judged "$program" sweep "$work/project" -o "$work/there" --merge --quiet >/dev/null
cmp "$work/here/samples.parquet" "$work/there/samples.parquet"
echo "the same bytes: through Slurm in $shards shards, $kept of them kept over the kill, and here in one run"
