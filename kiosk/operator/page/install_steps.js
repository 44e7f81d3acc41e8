// SPDX-License-Identifier: Apache-2.0
// The steps and their fields. The computer judges every value; nothing here does.

const isStatic = (family) => (values) => values[family] === "static";
const hasLogin = (values) => Boolean(values["login.method"]);
const isWith = (...methods) => (values) => methods.includes(values["login.method"]);
const isRound = (values) => values.shape !== "flat";
const isFlat = (values) => values.shape === "flat";

function cables(setup, value) {
  const options = [["", "All of them"], ...setup.cables.map((name) => [name, name])];
  if (value && !setup.cables.includes(value)) options.push([value, `${value} (not there)`]);
  return options;
}

function cameras(setup, value) {
  const options = [["", "Choose…"], ...setup.cameras.map((port) => [port, port])];
  if (value && !options.some(([port]) => port === value)) options.push([value, `${value} (not plugged in)`]);
  return options;
}

const isCalibrated = (setup, museum) => museum?.calibration?.state === "done" || setup.has_calibration;
const areInUse = (setup) => Object.values(setup.steps).every((step) => step.in_use);
const numbers = [...Array(8).keys()].map((i) => [String(i + 1), String(i + 1)]);

export function projectorFields(values, plugged) {
  const fields = [{ name: "count", label: "Number of projectors", options: numbers }];
  const sockets = [
    ["", "Choose…"],
    ...plugged.map((one) => [one.connector, `${one.connector}: ${one.text || "projector"} (${one.width_px} × ${one.height_px})`]),
  ];
  for (let i = 1; i <= Number(values.count || 0); ++i) {
    const own = values[`${i}.connector`];
    const options = own && !sockets.some(([name]) => name === own) ? [...sockets, [own, `${own} (nothing there)`]] : sockets;
    const group = `Projector ${i} from the left`;
    fields.push(
      { name: `${i}.name`, label: "Name", group },
      { name: `${i}.connector`, label: "Socket", options, group },
      {
        name: `${i}.turn_deg`,
        label: "Mounted",
        options: [
          ["0", "upright"],
          ["180", "upside down, under the ceiling"],
          ["90", "turned to the right"],
          ["270", "turned to the left"],
        ],
        group,
      },
      {
        name: `${i}.pjlink`,
        label: "Network address (PJLink)",
        hint: "For switching it on and off; leave it out if staff do that.",
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
    title: "Name and PIN",
    intro: "What this installation is called. The wall, the farm and the network know it by that name.",
    fields: [{ name: "museum", label: "Name", hint: "Such as Hall 3; on the network it is then hall-3.local." }],
  },
  {
    name: "network",
    title: "Network",
    intro:
      "Most museums need nothing here. New settings are tried for a minute, and taken back by themselves unless you confirm them.",
    use: "Try these settings for a minute",
    fields: [
      { name: "interface", label: "Network socket", options: cables },
      {
        name: "ipv4",
        label: "IPv4",
        options: [
          ["dhcp", "from the network (DHCP)"],
          ["static", "a fixed address"],
          ["off", "off"],
        ],
      },
      { name: "ipv4_address", label: "IPv4 address", hint: "With its length, such as 192.0.2.7/24.", when: isStatic("ipv4") },
      { name: "ipv4_gateway", label: "IPv4 router", when: isStatic("ipv4") },
      {
        name: "ipv6",
        label: "IPv6",
        options: [
          ["automatic", "from the network (SLAAC, DHCPv6)"],
          ["static", "a fixed address"],
          ["off", "off"],
        ],
      },
      { name: "ipv6_address", label: "IPv6 address", hint: "With its length, such as 2001:db8::7/64.", when: isStatic("ipv6") },
      { name: "ipv6_gateway", label: "IPv6 router", when: isStatic("ipv6") },
      { name: "dns", label: "Name servers", hint: "Leave them out to use those of the network." },
      { name: "time_servers", label: "Time servers", hint: "Leave them out to use those of the network." },
      { name: "vlan", label: "VLAN", hint: "A number, if the museum's switch separates networks.", isNumber: true },
      { name: "proxy", label: "Proxy for updates", hint: "Such as http://proxy.museum.example:3128." },
      {
        name: "login.method",
        label: "Login at the switch (802.1X)",
        options: [
          ["", "none"],
          ["peap", "name and password (PEAP)"],
          ["ttls", "name and password (TTLS)"],
          ["tls", "certificate (TLS)"],
        ],
      },
      { name: "login.identity", label: "Name for the login", when: hasLogin },
      { name: "login.password_file", label: "Password file", hint: "8021x-password, brought below.", when: isWith("peap", "ttls") },
      { name: "login.authority", label: "Authority's certificate", hint: "8021x-authority.crt, brought below.", when: hasLogin },
      { name: "login.server_name", label: "Name of the login server", when: hasLogin },
      { name: "login.certificate", label: "Certificate", hint: "8021x-certificate.crt, brought below.", when: isWith("tls") },
      { name: "login.key", label: "Key", hint: "8021x-key.pem, brought below.", when: isWith("tls") },
    ],
  },
  {
    name: "projectors",
    title: "Projectors",
    intro:
      "Switch all of them on. Put them in their order on the wall, from left to right; let one blink to see which it is, once the settings of this step are in use.",
    fields: [],
  },
  {
    name: "wall",
    title: "Wall",
    intro: "A few lengths from a tape measure. They only have to be about right: the calibration measures the rest.",
    fields: [
      {
        name: "shape",
        label: "The wall is",
        options: [
          ["round", "round, about the visitor"],
          ["flat", "flat"],
        ],
      },
      measured("radius_m", "Radius in m", "From the visitor's place to the wall.", isRound),
      measured("arc_deg", "Angle in degrees", "From the left end to the right end, seen from that place.", isRound),
      measured("width_m", "Width in m", "", isFlat),
      measured("distance_m", "Distance of the visitor in m", "", isFlat),
      measured("bottom_m", "Lower edge in m", "Above the floor."),
      measured("top_m", "Upper edge in m", "Above the floor."),
      measured("eye_m", "Visitor's eyes in m", "Above the floor; 1.65 is usual."),
      measured("lens_height_m", "Projectors' lenses in m", "Above the floor."),
      measured("lens_distance_m", "From lens to wall in m", ""),
      measured("picture_width_m", "Width of one picture in m", "Measured on the wall."),
    ],
  },
  {
    name: "cameras",
    title: "Camera",
    intro: "The camera that measures the wall, and its lens, which was measured with a printed board.",
    fields: [{ name: "calibration", label: "Camera on the turntable", options: cameras }],
  },
  {
    name: "calibration",
    title: "Calibration",
    intro: "The camera stands on its turntable at the visitor's place; the room is dark and empty, the projectors are warm.",
    state: (setup, museum) => (isCalibrated(setup, museum) ? "used" : "ready"),
    missing: (setup, museum) =>
      isCalibrated(setup, museum)
        ? "A calibration is in use."
        : "The wall has not been measured yet; until then the pictures follow from the lengths of step 4.",
  },
  {
    name: "farm",
    title: "Farm",
    intro: "The computers that make the pictures. The farm's operator gives you an address and three files.",
    fields: [
      {
        name: "coordinators",
        label: "Address of the farm",
        hint: "Such as farm.example.org:7401; several with commas between.",
      },
    ],
  },
  {
    name: "tour",
    title: "Tour",
    intro: "What visitors see, among the tours that the farm has granted to this museum.",
    fields: [{ name: "scene", label: "Name of the tour", hint: "Leave it out for the farm's first." }],
  },
  {
    name: "done",
    title: "Done",
    intro: "What is left, and a sheet for the folder in the museum's office.",
    state: (setup, museum) => (areInUse(setup) && isCalibrated(setup, museum) ? "used" : "open"),
    missing: (setup, museum) =>
      !areInUse(setup)
        ? "Some steps are not in use yet; the list of steps shows which."
        : isCalibrated(setup, museum)
          ? "Every step is in use."
          : "All settings are in use, but the wall has not been measured yet.",
  },
];
