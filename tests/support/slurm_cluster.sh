#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A Slurm cluster of two virtual nodes on this machine, for tests: its own munged, slurmctld and two slurmd, all of which
# live in a folder of their own and disturb no other Slurm.
#   slurm_cluster.sh start FOLDER [CORES]   starts it; then SLURM_CONF=FOLDER/slurm.conf for sbatch and others
#   slurm_cluster.sh restart FOLDER NAME    starts a daemon again that was killed: slurmctld, slurmd0 or slurmd1
#   slurm_cluster.sh stop FOLDER            ends what was started, and nothing else
# Exit code 77: a program is missing (Debian: slurmctld slurmd slurm-client munge) or may not be started here.
set -eu

command=$1
folder=$2
PATH=$PATH:/usr/sbin:/sbin
export SLURM_CONF="$folder/slurm.conf"

start_daemon() {
  case "$1" in
    munged) munged --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munge.pid" \
      --log-file="$folder/munge.log" --seed-file="$folder/munge.seed" --force >>"$folder/munged.out" 2>&1 & ;;
    slurmctld) slurmctld -D -i >>"$folder/slurmctld.out" 2>&1 & ;;
    slurmd*) slurmd -D -N "holdfast${1#slurmd}" >>"$folder/$1.out" 2>&1 & ;;
  esac
  echo $! >"$folder/$1.process"
}

case "$command" in
  start)
    for program in munged slurmctld slurmd sbatch squeue scancel; do
      command -v "$program" >/dev/null || { echo "$program is not installed"; exit 77; }
    done
    [ "$(id -u)" = 0 ] || { echo "the daemons are started as root only"; exit 77; }
    mkdir -p "$folder/state" "$folder/spool0" "$folder/spool1"
    chmod 755 "$folder"
    head -c 1024 /dev/urandom >"$folder/munge.key"
    chmod 600 "$folder/munge.key"
    base=$((20000 + $$ % 10000 * 3))
    cores=${3:-1}
    cat >"$folder/slurm.conf" <<END
ClusterName=holdfast_test
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=$base
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
CryptoType=crypto/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
SlurmdParameters=config_overrides
SlurmdTimeout=10
SlurmctldTimeout=10
MaxArraySize=5001
MaxJobCount=10000
MinJobAge=30
LaunchParameters=use_interactive_step
NodeName=holdfast0 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((base + 1)) CPUs=$cores State=UNKNOWN
NodeName=holdfast1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((base + 2)) CPUs=$cores State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
    mkdir -p "$folder/spoolholdfast0" "$folder/spoolholdfast1"
    start_daemon munged
    for _ in 1 2 3 4 5 6 7 8 9 10; do [ -S "$folder/munge.socket" ] && break; sleep 0.3; done
    start_daemon slurmctld
    start_daemon slurmd0
    start_daemon slurmd1
    for _ in $(seq 60); do
      if [ "$(sinfo -h -N -o '%T' 2>/dev/null | grep -c '^idle')" = 2 ]; then exit 0; fi
      sleep 0.5
    done
    echo "the cluster does not start; see $folder"
    sinfo -N -l 2>&1 || true
    tail -n 5 "$folder"/*.out
    exit 1
    ;;
  restart) start_daemon "$3" ;;
  stop)
    for daemon in slurmd0 slurmd1 slurmctld munged; do
      [ -f "$folder/$daemon.process" ] && kill "$(cat "$folder/$daemon.process")" 2>/dev/null || true
    done
    sleep 1
    for daemon in slurmd0 slurmd1 slurmctld munged; do
      [ -f "$folder/$daemon.process" ] && kill -9 "$(cat "$folder/$daemon.process")" 2>/dev/null || true
    done
    ;;
esac
