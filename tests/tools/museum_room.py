# SPDX-License-Identifier: Apache-2.0
"""The demo's room as a museum's: provisioning demands a connector for each of several projectors."""
import itertools
import re


def room_on(root, kind):
    """Text of demo/installation.toml below `root`, with the connectors `kind`-1, -2 ...: Virtual in QEMU, HDMI-A elsewhere."""
    numbers = itertools.count(1)
    text = (root / "demo/installation.toml").read_text(encoding="utf-8")
    return re.sub(r"^\[\[projector\]\]$", lambda found: f'{found[0]}\nconnector = "{kind}-{next(numbers)}"', text, flags=re.MULTILINE)
