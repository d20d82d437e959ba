#!/usr/bin/env bash
# A Slurm of one node on the loopback address, for trying things out: needs root and the Debian
# packages slurm-wlm and munge, and no systemd.
#
#   local-slurm.sh up FOLDER      then: export SLURM_CONF=FOLDER/slurm.conf
#   local-slurm.sh down FOLDER    ends the three daemons of FOLDER, and no others
set -euo pipefail
action=${1:?up or down} folder=${2:?a folder for the state}

wait_until() { # SECONDS COMMAND...
  local ends=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    if ((SECONDS >= ends)); then
      echo "local-slurm: gave up on: $*" >&2
      tail -n 5 "$folder"/*.log >&2 || true
      return 1
    fi
    sleep 0.2
  done
}

up() {
  local cpus memory key=$folder/munge
  cpus=$(nproc)
  memory=$(awk '/^MemTotal/ { print int($2 / 1024 / 2) }' /proc/meminfo)
  mkdir -p "$key" "$folder/state" "$folder/spool"
  chmod 755 "$folder" "$key"
  head -c 512 /dev/urandom >"$key/key"
  chmod 400 "$key/key"
  munged --force --key-file="$key/key" --socket="$key/socket" --pid-file="$folder/munged.pid" \
    --seed-file="$key/seed" --log-file="$folder/munged.log"
  cat >"$folder/slurm.conf" <<CONF
ClusterName=trial
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=26817
SlurmdPort=26818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$key/socket
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=2,batch_sched_delay=0
ReturnToService=2
MinJobAge=600
KillWait=2
NodeName=localhost NodeAddr=127.0.0.1 NodeHostname=$(hostname -s) CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=trial Nodes=localhost Default=YES State=UP
CONF
  printf 'CgroupPlugin=autodetect\nIgnoreSystemd=yes\n' >"$folder/cgroup.conf"
  export SLURM_CONF=$folder/slurm.conf
  wait_until 20 munge -n -S "$key/socket"
  slurmctld -c
  slurmd -N localhost
  wait_until 60 bash -c 'sinfo -h -o %T | grep -qE "^(idle|mixed|allocated)"'
}

down() {
  local name pid
  for name in slurmd slurmctld munged; do
    pid=$(cat "$folder/$name.pid" 2>/dev/null || true)
    if [[ -n $pid ]] && kill "$pid" 2>/dev/null; then
      wait_until 10 bash -c "! kill -0 $pid" || kill -9 "$pid"
    fi
  done
  rm -rf "$folder"
}

case $action in
up) up ;;
down) down ;;
*) echo "local-slurm: $action: say up or down" >&2 && exit 2 ;;
esac
