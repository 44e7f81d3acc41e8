#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# hosts_test.py runs this in the machine that it boots. It prints one line per check.
expect() { if "${@:2}"; then echo "ok: $1"; else echo "FAILED: $1"; fi; }
is() { [ "$(systemctl show -P "$2" "$1")" = "$3" ]; }
within() { local until=$((SECONDS + $1)); until "${@:2}"; do [ $SECONDS -lt $until ] || return 1; sleep 0.2; done; }
has_said() { journalctl -q -u "$1" -o cat | grep -qF -- "$2"; }
starts() { journalctl -q -u "$1" -o cat | grep -cF "Started $1"; }

dpkg -i /debs/*.deb > /dev/null 2>&1
expect "the packages configure themselves" test $? -eq 0
expect "nothing starts before it is set up" test "$(systemctl is-enabled cyclorama-farm cyclorama-node | sort -u)" = disabled
systemctl start cyclorama-farm --no-block
expect "the coordinator reports what it lacks" within 10 has_said cyclorama-farm '[[scene]]'
systemctl stop cyclorama-farm

mkdir -p /srv/scenes
printf 'v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 3 2\nf 1 4 3\n' > /srv/scenes/sheet.obj
sed -i 's/^#\[\[scene\]\]/[[scene]]/; s/^#name = .*/name = "sheet"/; s|^#path = .*|path = "/srv/scenes/sheet.obj"|' /etc/cyclorama/farm.toml
echo 'coordinators = ["[::1]:7402"]' >> /etc/cyclorama/node.toml
systemctl enable -q --now cyclorama-farm cyclorama-node
expect "both run" within 20 systemctl -q is-active cyclorama-farm cyclorama-node
expect "the node has the scene" within 30 has_said cyclorama-farm "has scene 'sheet'"
for unit in cyclorama-farm cyclorama-node; do
  expect "$unit runs as itself" test "$(stat -c %U "/proc/$(systemctl show -P MainPID $unit)")" = $unit
  expect "$unit reports its status to systemd" test -n "$(systemctl show -P StatusText $unit)"
  expect "$unit was not started twice" is $unit NRestarts 0
  systemd-analyze security "$unit.service" --no-pager | tail -1
done

systemctl kill -s KILL cyclorama-node
expect "a killed node restarts" within 20 is cyclorama-node NRestarts 1
expect "and loads its scene" within 20 test "$(journalctl -q -u cyclorama-farm -o cat | grep -c 'is gone')" -ge 1
systemctl kill -s STOP cyclorama-farm
expect "the watchdog restarts a coordinator that hangs" within 60 is cyclorama-farm NRestarts 1
expect "and runs" within 20 systemctl -q is-active cyclorama-farm
for unit in cyclorama-node cyclorama-farm; do
  systemctl stop $unit
  expect "$unit ends by itself" test "$(systemctl show -P Result $unit) $(systemctl show -P ExecMainStatus $unit)" = "success 0"
done
expect "no process was killed for a refused system call" test -z "$(journalctl -q | grep -i 'status=31/SYS')"

dpkg -P cyclorama-farm cyclorama-node > /dev/null 2>&1
expect "they are removed" test $? -eq 0
expect "and leave nothing" test ! -e /etc/cyclorama -a ! -e /var/lib/cyclorama-node -a ! -e /var/log/cyclorama-farm
journalctl -q -b -p warning -o cat | grep -i cyclorama | sort | uniq -c | sort -rn | head -20
echo checked
