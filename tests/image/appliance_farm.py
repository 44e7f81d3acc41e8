# SPDX-License-Identifier: Apache-2.0
"""Tests the whole show: a farm on the host sends pictures to the computer over IPv6 and TLS, the kernel's virtual
camera shows a rendered wand, and the view on the heads turns with the wand. Then faults of a museum's day follow: the
camera and a head are unplugged, the disk is full, the farm is down. It needs the Debug image, since the shipped one has
no virtual camera and no shell; appliance_mission.py tests that one with a USB camera."""
import functools
import pathlib
import subprocess
import sys
import time

from appliance import HEADS, HEIGHT, WIDTH, Appliance, reference_pictures, save_png
from appliance_boot import attract_pictures, computer, is_as, wait_for_pictures
from disk_image import stick
from host_farm import HostFarm

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/tools"))
from museum_room import room_on  # noqa: E402
# Beyond the dead angle of 5.7 degrees and far below full speed: a degree per second, so that consecutive pictures can
# be matched.
WANDS = {"rest": (0.0, 1.0), "right": (14.0, 1.0), "left": (-14.0, 1.0)}
FRAME = 640 * 480  # Bytes of the camera's grey picture.
# A quarter of the pixels: an emulated processor that also tracks the wand needs 10 s or more for three heads of
# 640x480.
SMALL = (320, 240)
PICTURE_PX = 384
VIVID = "vivid n_devs=1 node_types=0x101 num_inputs=1 input_types=3 num_outputs=1 output_types=1"
TRACKER = '[camera]\nkind = "v4l2"\nport = "platform:vivid-000"\n[detector]\nthreads = 1\n'
SHOWS_WITHIN_S = 600
# Pictures per wand; after the wand comes to rest the view still moves to its target.
BEGINS_S, TURNS_S, SETTLES_S = 240, 40, 20
MAX_MOVED_AT_REST_PX = 8  # Pixels in all of them together; the rays' noise may mislead by a pixel or two.
# Mean in code values. The grotto is as dark as the attract picture's evening sky and differs from it by 3 to 6; the
# attract
MIN_DIFFERENCE = 2.0
# picture's tolerance is 1.5.


def wand_pictures(programs, folder):
    """Returns {wand: grey bytes of 640x480}, rendered."""
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {}
    for name, (yaw_deg, distance_m) in WANDS.items():
        picture = folder / f"{name}.grey"
        subprocess.run([str(programs / "test-wand"), str(picture), str(yaw_deg), str(distance_m)], check=True)
        pictures[name] = picture.read_bytes()
    return pictures


def wand_disk(programs, folder):
    """Returns QEMU's options for a disk that holds the camera pictures one after the other."""
    file = folder / "wand.img"
    pictures = wand_pictures(programs, folder)
    file.write_bytes(b"".join(pictures.values()))
    return ["-drive", f"if=none,id=wand,format=raw,readonly=on,file={file}", "-device",
            "virtio-blk-pci,drive=wand,serial=wand"]


def plug_camera(machine):
    """Sets up vivid as test-camera does (tests/tools/vivid.cpp): output connected to input, both 640x480, grey, no
    text. The tracker is stopped meanwhile, since it would open the camera."""
    machine.run(f"systemctl stop cyclorama-tracker; modprobe {VIVID}", 120)
    for number, name in enumerate(WANDS):
        machine.run(f"dd if=/dev/disk/by-id/virtio-wand of=/run/{name}.grey bs={FRAME} skip={number} count=1", 60)
    output = machine.run("""for node in /sys/class/video4linux/video*; do
      case $(cat $node/name) in vivid-*-vid-out) out=/dev/${node##*/} ;; vivid-*-vid-cap) in=/dev/${node##*/} ;; esac
    done
    v4l2-ctl -d $in --set-dv-bt-timings=index=0 --set-ctrl osd_text_mode=2
    v4l2-ctl -d $out --set-dv-bt-timings=index=0
    v4l2-ctl -d $out --set-fmt-video-out=width=640,height=480,pixelformat=GREY
    # One switch until kernel 6.11; since then each input is connected to an output.
    v4l2-ctl -d $in --set-ctrl loop_video=1 >/dev/null 2>&1 || v4l2-ctl -d $in --set-ctrl hdmi_000_0_is_connected_to=2
    >/dev/null
    echo in $in out $out; echo $out >/run/wand-node""", 120)[1]
    machine.run("systemctl start cyclorama-tracker", 60)
    return output


def show_wand(machine, name):
    """Makes the camera show this wand from now on."""
    machine.run("systemctl stop wand 2>/dev/null; systemd-run -q --collect --unit=wand -p StandardOutput=null -p StandardError=null "
                f"v4l2-ctl -d $(cat /run/wand-node) --stream-out-mmap=3 --stream-from=/run/{name}.grey --stream-loop",
                60)


def moved_px(one, other, most=100):
    """Returns by how many pixels the middle of `one` has moved to the right in `other`. It compares patches, not
    columns' means, which mostly show the blend, which does not move."""
    width, height, _ = one
    columns, rows = range(width // 2 - 50, width // 2 + 50, 2), range(height // 4, 3 * height // 4, 4)

    def patch(picture, shift):
        values = [picture[2][3 * (y * width + x + shift) + 1] for y in rows for x in columns]
        mean = sum(values) / len(values)
        size = sum((value - mean) ** 2 for value in values) ** 0.5 or 1
        return [(value - mean) / size for value in values]

    wanted = patch(one, 0)
    return max(range(-most, most + 1), key=lambda shift: sum(a * b for a, b in zip(wanted, patch(other, shift))))


def mean_difference(one, other):
    pairs = list(zip(one[2][::31], other[2][::31]))
    return sum(abs(p - q) for p, q in pairs) / len(pairs)


def wait_for(condition, seconds):
    """Returns the seconds until the condition holds, or None."""
    began = time.monotonic()
    while time.monotonic() < began + seconds:
        if condition():
            return round(time.monotonic() - began, 1)
        time.sleep(1)
    return None


def live(machine, reference):
    """Returns for each head whether it is lit and shows another picture than the attract picture."""
    return [shown is not None and shown[:2] == wanted[:2] and sum(shown[2][::97]) > 3 * len(shown[2][::97]) and
            mean_difference(shown, wanted) > MIN_DIFFERENCE for shown, wanted in zip(machine.heads(), reference)]


def is_live(machine, reference):
    return all(live(machine, reference))


def is_attracting(machine, reference):
    return all(is_as(shown, wanted) for shown, wanted in zip(machine.heads(), reference))


def stick_of_farm(folder, farm, **others):
    """Returns a museum's stick for this farm, its camera and its small projectors. `others` adds or replaces files by
    name, such as operator="..." for operator.toml."""
    installation = room_on(ROOT, "Virtual").replace(f"width_px = {WIDTH}", f"width_px = {SMALL[0]}")
    installation = installation.replace(f"height_px = {HEIGHT}", f"height_px = {SMALL[1]}")
    texts = {"site": farm.site(), "tracker": TRACKER, "installation": installation} | others
    contents = dict(farm.on_stick())
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)
        contents[f"cyclorama/{name}.toml"] = folder / f"{name}.toml"
    image = folder / "farm.img"
    stick(image, 40, contents)
    return image


def look_how_it_turns(machine, show, wand, folder):
    """Returns [pixels that the middle head's picture moved to the right] between consecutive pictures after
    show(wand)."""
    show(wand)
    seen = [machine.picture(1)]
    changed_at = deadline = None
    began = time.monotonic()
    # An ongoing movement ends first, and the next may start late: a busy computer is slow, not wrong.
    while time.monotonic() < (deadline or began + BEGINS_S):
        time.sleep(0.3)
        now = machine.picture(1)
        if now[2] != seen[-1][2]:
            # The pose of a resting wand varies slightly; the view rests, and only its noise changes.
            if abs(moved_px(seen[-1], now)) > 1:
                changed_at = time.monotonic()
            seen.append(now)
            if folder:
                save_png(now, folder / f"turn-{wand}-{len(seen):03}.png")
        if deadline is None and (changed_at is not None if wand != "rest"
                                 else time.monotonic() - (changed_at or began) > SETTLES_S):
            deadline = time.monotonic() + TURNS_S
            if wand == "rest":
                seen = seen[-1:]
    return [moved_px(one, other) for one, other in zip(seen, seen[1:])]


def check_steering(machine, show, options, figures):
    figures["steering"] = []
    total = {"rest": [], "right": [], "left": []}
    for number, wand in enumerate(("rest", "right", "rest", "left", "rest")):
        moved = look_how_it_turns(machine, show, wand, options.pictures)
        total[wand].append(sum(moved))
        figures["steering"].append({"wand": wand, "moved_px": moved})
        print(figures["steering"][-1], flush=True)
        keep_pictures(machine, options, f"{options.part}-{number}-{wand}")
    if any(abs(moved) > MAX_MOVED_AT_REST_PX for moved in total["rest"]):
        figures["failed"].append(f"the view moves while the wand rests: {total}")
    # Turning right moves the picture to the left.
    if total["right"][0] > -2 * MAX_MOVED_AT_REST_PX or total["left"][0] < 2 * MAX_MOVED_AT_REST_PX:
        figures["failed"].append(f"the view does not turn with the wand: {total}")


def keep_pictures(machine, options, name):
    if not options.pictures:
        return
    options.pictures.mkdir(parents=True, exist_ok=True)
    for head, picture in enumerate(machine.heads()):
        if picture:
            save_png(picture, options.pictures / f"{name}-head{head}.png")


def check_farm_away(machine, show, farm, reference, figures):
    """While the farm is down, a picture that is still right stays until the visitor turns and no new picture
    arrives."""
    farm.stop()
    show("right")
    figures["farm_away_attract_s"] = wait_for(lambda: is_attracting(machine, reference), SHOWS_WITHIN_S)
    show("rest")
    farm.start()
    figures["farm_back_live_s"] = wait_for(lambda: is_live(machine, reference), SHOWS_WITHIN_S)
    for what in ("farm_away_attract_s", "farm_back_live_s"):
        if figures[what] is None:
            figures["failed"].append(f"{what}: not within {SHOWS_WITHIN_S} s")
    print({name: value for name, value in figures.items() if name.startswith("farm_")}, flush=True)


def check_camera(machine, figures):
    """Unplugs the camera and plugs it in again."""
    since = "journalctl -b -o cat -u cyclorama-tracker --no-pager | grep -c 'Follows'"
    before = int(machine.run(since)[1].split()[-1])
    machine.run("systemctl stop wand; echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind", 60)
    gone = wait_for(lambda: machine.run("journalctl -b -o cat -u cyclorama-tracker --no-pager | tail -n 3 | grep -c 'No pictures'")[1].endswith("1"), 120)
    machine.run("systemctl stop cyclorama-tracker; echo vivid.0 >/sys/bus/platform/drivers/vivid/bind", 60)
    plug_camera(machine)
    show_wand(machine, "rest")
    back = wait_for(lambda: int(machine.run(since)[1].split()[-1]) > before, 240)
    figures["camera_gone_told_s"], figures["camera_back_s"] = gone, back
    if gone is None or back is None:
        figures["failed"].append(f"camera unplugged: reported after {gone} s, back after {back} s")
    print(f"camera: its loss is reported after {gone} s, back after {back} s", flush=True)


def check_head(machine, reference, figures):
    """Unplugs the last head's projector and plugs it in again; the others continue."""
    last = HEADS - 1
    machine.resize(last, 0, 0)
    gone = wait_for(lambda: not live(machine, reference)[last], 240)
    time.sleep(5)
    others = live(machine, reference)[:last]
    machine.plug_in(last, *SMALL)
    back = wait_for(lambda: is_live(machine, reference), SHOWS_WITHIN_S)
    figures["head_gone_s"], figures["others_live"], figures["head_back_s"] = gone, all(others), back
    if gone is None or not all(others) or back is None:
        figures["failed"].append(f"head unplugged: dark after {gone} s, the others live: {others}, back after {back} s")
    print(f"head: dark after {gone} s, the others live: {others}, back after {back} s", flush=True)


def check_full_disk(machine, reference, figures):
    """Fills the disk and frees it again; the show goes on."""
    machine.run("fallocate -l $(($(df --output=avail -B1 /var | tail -n 1) - 4096)) /var/full || dd if=/dev/zero of=/var/full bs=1M; echo x >/var/lib/more", 300)
    free = machine.run("df --output=avail -k /var | tail -n 1")[1].strip()
    time.sleep(20)
    failed = machine.run("systemctl --failed --no-legend --plain | cut -d' ' -f1")[1].split()
    live = is_live(machine, reference)
    machine.run("rm -f /var/full /var/lib/more")
    figures["full_disk"] = {"free_kb": free, "failed_units": failed, "live": live}
    if failed or not live:
        figures["failed"].append(f"a full disk: {figures['full_disk']}")
    print("full disk:", figures["full_disk"], flush=True)


def ask_for_small_pictures(machine):
    """Limits the width of the farm's pictures to what an emulated processor can decode, by a drop-in."""
    place = "/run/systemd/system/cyclorama-display.service.d"
    machine.run(f"mkdir -p {place}; (echo [Service]; echo ExecStart=; sed -n '/^ExecStart=/s/$/ --width {PICTURE_PX}/p' "
                f"/usr/lib/systemd/system/cyclorama-display.service) >{place}/small.conf; systemctl daemon-reload", 120)


def check(machine, options, folder, figures):
    """Tests a running computer with three heads, whose QEMU has wand_disk() and a network that reaches the host."""
    farm = HostFarm(options.programs, folder / "farm")
    farm.start()
    show = functools.partial(show_wand, machine)
    try:
        print(plug_camera(machine), flush=True)
        show("rest")
        ask_for_small_pictures(machine)
        for head in range(HEADS):
            machine.plug_in(head, *SMALL)
            time.sleep(5)
        machine.plug_stick(stick_of_farm(folder, farm), "farm")
        reference = reference_pictures(options.programs, folder / "installation.toml", folder / "small")
        figures["live_s"] = wait_for(lambda: is_live(machine, reference), SHOWS_WITHIN_S)
        print(f"live after {figures['live_s']} s", flush=True)
        keep_pictures(machine, options, "farm-live")
        if figures["live_s"] is None:
            figures["failed"].append("no live picture on every head")
            print(machine.run("top -b -n1 -w150 | head -20; cat /var/lib/cyclorama/provisioning.json; journalctl -b -n 40 -o cat --no-pager -u 'cyclorama-*'", 120)[1])
            return
        check_steering(machine, show, options, figures)
        check_head(machine, reference, figures)
        check_camera(machine, figures)
        check_full_disk(machine, reference, figures)
        check_farm_away(machine, show, farm, reference, figures)
    finally:
        farm.stop()
        for head in range(HEADS):
            machine.plug_in(head)


def run(options, folder):
    figures = {"failed": []}
    reference = attract_pictures(options, folder)
    machine = Appliance(computer(options, folder), network="ipv4=on,ipv6=on", extra=wand_disk(options.programs, folder))
    try:
        machine.wait_for_shell(900)
        if len(wait_for_pictures(machine, reference)) < HEADS:
            figures["failed"].append("no attract picture on every head")
        else:
            check(machine, options, folder, figures)
    finally:
        machine.power_off()
    return figures
