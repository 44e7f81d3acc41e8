# SPDX-License-Identifier: Apache-2.0
# Doxygen's filter of a header; lines keep their numbers. `///` comments become /** ones, in which examples can stand
# as they are: what is indented by three blanks or more (diagrams, settings, tables) is printed verbatim. A comment
# that follows the licence line is the file's.
function put(line) {  # One line late, since the next one may have to add to it.
  if (NR > 1) print held
  held = line
}
# Prose has no HTML; in `code` nothing is changed.
function escaped(text,   parts, n, i, all) {
  gsub(/`\.\//, "`", text)  # In "`./bench.sh`" the dot would end the sentence.
  n = split(text, parts, "`")
  for (i = 1; i <= n; ++i) {
    if (i % 2) gsub(/</, "\\&lt;", parts[i])
    all = all (i > 1 ? "`" : "") parts[i]
  }
  return all
}
function end_comment() {
  if (is_verbatim) held = held " @endverbatim"
  if (is_comment) held = held " */"
  is_verbatim = is_comment = 0
}
{
  if (!match($0, /^ *\/\/\/([^<]|$)/)) {
    end_comment()
    if (match($0, /\/\/\/</)) {
      put(substr($0, 1, RSTART + 3) escaped(substr($0, RSTART + 4)))
    } else {
      put($0)
    }
    next
  }
  margin = $0
  sub(/\/.*/, "", margin)
  text = substr($0, length(margin) + 4)
  gsub(/\*\//, "* /", text)
  start = ""
  if (!is_comment) {
    start = "/**"
    if (NR == 2) {
      held = "/** @file"
      start = ""
    }
  }
  is_comment = 1
  if (text ~ /^   / && !is_verbatim) {
    if (start == "") {
      held = held " @verbatim"
    } else {
      start = start " @verbatim"
    }
    is_verbatim = 1
  } else if (is_verbatim && text !~ /^   / && text !~ /^ *$/) {
    start = start " @endverbatim"
    is_verbatim = 0
  }
  put(margin start (is_verbatim ? text : escaped(text)))
}
END {
  end_comment()
  print held
}
