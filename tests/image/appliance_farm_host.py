# SPDX-License-Identifier: Apache-2.0
"""Tests a render host's image (image/build --farm-host --debug).

It starts without settings, becomes a farm's coordinator and node by a stick with their certificates and a scene, and
renders for a museum on the host. From outside only the ports for museums and nodes answer. QEMU forwards IPv4 only;
inside, the node connects to its coordinator over IPv6.
"""
import json
import pathlib
import subprocess
import threading
import time

from appliance import Appliance, Disk, flashable
from appliance_provision import expect
from appliance_security import compare, look_at_running
from disk_image import stick
from host_farm import MUSEUM, HostFarm

STARTS_WITHIN_S = 900
FRAMES_WITHIN_S = 600
FORWARDED = 17411  # On the host's loopback; forwarded to the coordinator's port for museums.
PORTS = (7401, 7402)
HEAD = """museums = "[::]:7401"
nodes = "[::]:7402"
inspect = "unix:/run/cyclorama-farm/inspect.sock"
audit = "/var/log/cyclorama-farm/audit.jsonl"
[[scene]]
name = "grotto"
path = "/etc/cyclorama/grotto"
on = "coordinator"
[distribution]
digests = "/var/lib/cyclorama-farm/digests"
"""
NODE = 'coordinators = ["[::1]:7402"]\nname = "render-1"\ncache = "/var/lib/cyclorama-node"\n'


def tls(folder):
    return f'[tls]\nauthority = "{folder}/authority.crt"\ncertificate = "{folder}/certificate.crt"\nkey = "{folder}/key.pem"\n'


def stick_of_host(farm, folder, name="host", node=NODE):
    """Returns the image of a stick with this host's settings, certificates and scene."""
    contents = {f"cyclorama/grotto/{path.name}": path for path in (farm.folder / "scene").iterdir()}
    for role in ("coordinator", "node"):
        contents |= {f"cyclorama/tls-{role}/{file}": farm.folder / role / file for file in ("authority.crt", "certificate.crt", "key.pem")}
    for file, text in (("farm.toml", HEAD + tls("tls-coordinator")), ("node.toml", node + tls("tls-node"))):
        (folder / f"{name}-{file}").write_text(text)
        contents[f"cyclorama/{file}"] = folder / f"{name}-{file}"
    image = folder / f"{name}.img"
    stick(image, 60, contents)
    return image


def visit(programs, farm, seconds, wanted=3):
    """Returns (seconds until so many whole pictures had arrived, or None; the newest one's report). `programs` is the
    build's bin."""
    began = time.monotonic()
    command = [pathlib.Path(programs).parent / "tests/test-museum", "--farm", f"127.0.0.1:{FORWARDED}", "--bundle", farm.folder / "museum",
               "--museum", MUSEUM, "--width", "256", "--height", "128", "--rate-hz", "1", "--timeout-s", str(seconds)]
    museum = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    newest, whole = None, 0
    enough = threading.Timer(seconds, museum.kill)
    enough.start()
    try:
        for line in museum.stdout:
            event = json.loads(line)
            if event.get("event") == "violation":
                raise RuntimeError(line)
            if event.get("event") == "frame" and event.get("whole"):
                newest, whole = event, whole + 1
            if whole >= wanted:
                return round(time.monotonic() - began, 1), newest
    finally:
        enough.cancel()
        museum.kill()
        museum.wait()
    return None, newest


def check_pictures(options, farm, figures, name):
    figures[name], newest = visit(options.programs, farm, FRAMES_WITHIN_S)
    if figures[name] is None:
        figures["failed"].append(f"{name}: no pictures within {FRAMES_WITHIN_S} s")
    else:
        figures[f"{name}_frame"] = {key: newest[key] for key in ("nodes", "tiles", "bytes", "stages_ms") if key in newest}
    print(f"{name}: {figures[name]} s, {newest and newest.get('stages_ms')}", flush=True)


def check(machine, options, farm, folder, figures):
    both = "systemctl is-active cyclorama-farm cyclorama-node | sort -u | tr '\\n' ' '"
    expect(machine, figures, "secure boot", "dmesg | grep -i 'secure boot'", "Secure boot enabled")
    expect(machine, figures, "/var", "cat /run/cyclorama/var", "encrypted")
    expect(machine, figures, "without settings nothing runs", both, "inactive")
    expect(machine, figures, "and the start succeeds", "systemctl show -P Result cyclorama-health", "success")
    if not machine.plug_stick(stick_of_host(farm, folder), "host", 600):
        figures["failed"].append("the stick was not checked")
    expect(machine, figures, "the stick", "cat /var/lib/cyclorama/provisioning.json", "installed")
    expect(machine, figures, "coordinator and node run", f"for i in $(seq 120); do [ \"$({both})\" = 'active ' ] && break; sleep 1; done; {both}", "active ")
    check_pictures(options, farm, figures, "first_pictures_s")
    if not machine.plug_stick(stick_of_host(farm, folder, "bad", 'threds = 2\n' + NODE), "bad", 600):
        figures["failed"].append("the bad stick was not checked")
    expect(machine, figures, "a bad stick", "cat /var/lib/cyclorama/provisioning.json", "threds")
    expect(machine, figures, "changes nothing", "cat /etc/cyclorama/node.toml", "render-1")
    expect(machine, figures, "and is reported on the serial port", "systemctl show -P Result cyclorama-tell-settings", "success")


def run(options, folder):
    figures = {"failed": []}
    farm = HostFarm(options.programs, folder / "farm", ("127.0.0.1", "::1"))
    shipped = options.out / "cyclorama-farm-host"
    for name in ("setuid", "users") if shipped.exists() else ():
        compare(f"farm-host/{name}", (shipped / name).read_text().splitlines(), figures["failed"])
    disk = Disk(folder / "computer", flashable(options.out / "cyclorama-farm-host-debug"))
    machine = Appliance(disk, coordinators=0, network=f"ipv4=on,ipv6=on,hostfwd=tcp:127.0.0.1:{FORWARDED}-:7401")
    try:
        machine.wait_for_shell(STARTS_WITHIN_S)
        machine.run("systemctl is-system-running --wait", STARTS_WITHIN_S)
        figures["shell_s"] = round(machine.seconds(), 1)
        check(machine, options, farm, folder, figures)
        machine.restart(STARTS_WITHIN_S)
        machine.run("systemctl is-system-running --wait", STARTS_WITHIN_S)
        check_pictures(options, farm, figures, "pictures_after_a_restart_s")
        look_at_running(machine, figures, "farm-host/", PORTS)
    finally:
        machine.power_off()
    return figures
