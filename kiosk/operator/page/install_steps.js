// SPDX-License-Identifier: Apache-2.0
// The steps and their fields. The computer judges every value; nothing here does.
import { tr } from "./texts.js";

const isStatic = (family) => (values) => values[family] === "static";
const hasLogin = (values) => Boolean(values["login.method"]);
const isWith =
  (...methods) =>
  (values) =>
    methods.includes(values["login.method"]);
const isRound = (values) => values.shape !== "flat";
const isFlat = (values) => values.shape === "flat";

function cables(setup, value) {
  const options = [["", tr("All of them")], ...setup.cables.map((name) => [name, name])];
  if (value && !setup.cables.includes(value)) options.push([value, tr("{name} (not there)", { name: value })]);
  return options;
}

function cameras(setup, value) {
  const options = [["", tr("Choose…")], ...setup.cameras.map((port) => [port, port])];
  if (value && !options.some(([port]) => port === value))
    options.push([value, tr("{name} (not plugged in)", { name: value })]);
  return options;
}

const isCalibrated = (setup, museum) => museum?.calibration?.state === "done" || setup.has_calibration;
const areInUse = (setup) => Object.values(setup.steps).every((step) => step.in_use);
const numbers = [...Array(8).keys()].map((i) => [String(i + 1), String(i + 1)]);

export function projectorFields(values, plugged) {
  const fields = [{ name: "count", label: tr("Number of projectors"), options: numbers }];
  const sockets = [
    ["", tr("Choose…")],
    ...plugged.map((one) => [
      one.connector,
      `${one.connector}: ${one.text || tr("projector")} (${one.width_px} × ${one.height_px})`,
    ]),
  ];
  for (let i = 1; i <= Number(values.count || 0); ++i) {
    const own = values[`${i}.connector`];
    const options =
      own && !sockets.some(([name]) => name === own)
        ? [...sockets, [own, tr("{name} (nothing there)", { name: own })]]
        : sockets;
    const group = tr("Projector {n} from the left", { n: i });
    fields.push(
      { name: `${i}.name`, label: tr("Name"), group },
      { name: `${i}.connector`, label: tr("Socket"), options, group },
      {
        name: `${i}.turn_deg`,
        label: tr("Mounted"),
        options: [
          ["0", tr("upright")],
          ["180", tr("upside down, under the ceiling")],
          ["90", tr("turned to the right")],
          ["270", tr("turned to the left")],
        ],
        group,
      },
      {
        name: `${i}.pjlink`,
        label: tr("Network address (PJLink)"),
        hint: tr("For switching it on and off; leave it out if staff do that."),
        group,
        after: i,
      },
    );
  }
  return fields;
}

const measured = (name, label, hint, when) => ({ name, label, hint, when, isNumber: true });

export const steps = [
  {
    name: "name",
    title: tr("Name and PIN"),
    intro: tr("What this installation is called. The wall, the farm and the network know it by that name."),
    fields: [
      { name: "museum", label: tr("Name"), hint: tr("Such as Hall 3; on the network it is then hall-3.local.") },
    ],
  },
  {
    name: "network",
    title: tr("Network"),
    intro: tr(
      "Most museums need nothing here. New settings are tried for a minute, and taken back by themselves unless you confirm them.",
    ),
    use: tr("Try these settings for a minute"),
    fields: [
      { name: "interface", label: tr("Network socket"), options: cables },
      {
        name: "ipv4",
        label: "IPv4",
        options: [
          ["dhcp", tr("from the network (DHCP)")],
          ["static", tr("a fixed address")],
          ["off", tr("off")],
        ],
      },
      {
        name: "ipv4_address",
        label: "IPv4 address",
        hint: tr("With its length, such as 192.0.2.7/24."),
        when: isStatic("ipv4"),
      },
      { name: "ipv4_gateway", label: "IPv4 router", when: isStatic("ipv4") },
      {
        name: "ipv6",
        label: "IPv6",
        options: [
          ["automatic", tr("from the network (SLAAC, DHCPv6)")],
          ["static", tr("a fixed address")],
          ["off", tr("off")],
        ],
      },
      {
        name: "ipv6_address",
        label: "IPv6 address",
        hint: tr("With its length, such as 2001:db8::7/64."),
        when: isStatic("ipv6"),
      },
      { name: "ipv6_gateway", label: "IPv6 router", when: isStatic("ipv6") },
      { name: "dns", label: tr("Name servers"), hint: tr("Leave them out to use those of the network.") },
      { name: "time_servers", label: tr("Time servers"), hint: tr("Leave them out to use those of the network.") },
      { name: "vlan", label: "VLAN", hint: tr("A number, if the museum's switch separates networks."), isNumber: true },
      { name: "proxy", label: tr("Proxy for updates"), hint: tr("Such as http://proxy.museum.example:3128.") },
      {
        name: "login.method",
        label: tr("Login at the switch (802.1X)"),
        options: [
          ["", tr("none")],
          ["peap", tr("name and password (PEAP)")],
          ["ttls", tr("name and password (TTLS)")],
          ["tls", tr("certificate (TLS)")],
        ],
      },
      { name: "login.identity", label: tr("Name for the login"), when: hasLogin },
      {
        name: "login.password_file",
        label: tr("Password file"),
        hint: tr("8021x-password, brought below."),
        when: isWith("peap", "ttls"),
      },
      {
        name: "login.authority",
        label: "Authority's certificate",
        hint: tr("8021x-authority.crt, brought below."),
        when: hasLogin,
      },
      { name: "login.server_name", label: tr("Name of the login server"), when: hasLogin },
      {
        name: "login.certificate",
        label: tr("Certificate"),
        hint: tr("8021x-certificate.crt, brought below."),
        when: isWith("tls"),
      },
      { name: "login.key", label: tr("Key"), hint: tr("8021x-key.pem, brought below."), when: isWith("tls") },
    ],
  },
  {
    name: "projectors",
    title: tr("Projectors"),
    intro: tr(
      "Switch all of them on. Put them in their order on the wall, from left to right; let one blink to see which it is, once the settings of this step are in use.",
    ),
    fields: [],
  },
  {
    name: "wall",
    title: tr("Wall"),
    intro: tr(
      "A few lengths from a tape measure. They only have to be about right: the calibration measures the rest.",
    ),
    fields: [
      {
        name: "shape",
        label: tr("The wall is"),
        options: [
          ["round", tr("round, about the visitor")],
          ["flat", tr("flat")],
        ],
      },
      measured("radius_m", tr("Radius in m"), tr("From the visitor's place to the wall."), isRound),
      measured(
        "arc_deg",
        tr("Angle in degrees"),
        tr("From the left end to the right end, seen from that place."),
        isRound,
      ),
      measured("width_m", tr("Width in m"), "", isFlat),
      measured("distance_m", tr("Distance of the visitor in m"), "", isFlat),
      measured("bottom_m", tr("Lower edge in m"), tr("Above the floor.")),
      measured("top_m", tr("Upper edge in m"), tr("Above the floor.")),
      measured("eye_m", tr("Visitor's eyes in m"), tr("Above the floor; 1.65 is usual.")),
      measured("lens_height_m", tr("Projectors' lenses in m"), tr("Above the floor.")),
      measured("lens_distance_m", tr("From lens to wall in m"), ""),
      measured("picture_width_m", tr("Width of one picture in m"), tr("Measured on the wall.")),
    ],
  },
  {
    name: "cameras",
    title: tr("Camera"),
    intro: tr("The camera that measures the wall, and its lens, which was measured with a printed board."),
    fields: [{ name: "calibration", label: tr("Camera on the turntable"), options: cameras }],
  },
  {
    name: "calibration",
    title: tr("Calibration"),
    intro: tr(
      "The camera stands on its turntable at the visitor's place; the room is dark and empty, the projectors are warm.",
    ),
    state: (setup, museum) => (isCalibrated(setup, museum) ? "used" : "ready"),
    missing: (setup, museum) =>
      isCalibrated(setup, museum)
        ? tr("A calibration is in use.")
        : tr("The wall has not been measured yet; until then the pictures follow from the lengths of step 4."),
  },
  {
    name: "farm",
    title: tr("Farm"),
    intro: tr("The computers that make the pictures. The farm's operator gives you an address and three files."),
    fields: [
      {
        name: "coordinators",
        label: tr("Address of the farm"),
        hint: tr("Such as farm.example.org:7401; several with commas between."),
      },
    ],
  },
  {
    name: "tour",
    title: tr("Tour"),
    intro: tr("What visitors see, among the tours that the farm has granted to this museum."),
    fields: [{ name: "scene", label: tr("Name of the tour"), hint: tr("Leave it out for the farm's first.") }],
  },
  {
    name: "done",
    title: tr("Done"),
    intro: tr("What is left, and a sheet for the folder in the museum's office."),
    state: (setup, museum) => (areInUse(setup) && isCalibrated(setup, museum) ? "used" : "open"),
    missing: (setup, museum) =>
      !areInUse(setup)
        ? tr("Some steps are not in use yet; the list of steps shows which.")
        : isCalibrated(setup, museum)
          ? tr("Every step is in use.")
          : tr("All settings are in use, but the wall has not been measured yet."),
  },
];
