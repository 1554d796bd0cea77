#!/bin/sh
# Looks that every public name in include/swarmflow is documented, and that doxygen has no other warning about it.
#   tests/doxygen.sh      Prints what is missing; fails if anything is, or without doxygen.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
command -v doxygen >/dev/null || { echo "doxygen is missing: deploy/install_packages.sh deploy/test_packages.txt" >&2; exit 2; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$root"
{
  cat docs/Doxyfile
  printf '%s\n' "OUTPUT_DIRECTORY = $out" "WARN_LOGFILE = $out/warnings.txt" "GENERATE_HTML = NO" "GENERATE_XML = YES" \
    "XML_PROGRAMLISTING = NO"
} >"$out/Doxyfile"
doxygen "$out/Doxyfile" >"$out/output.txt" 2>&1 || { cat "$out/output.txt" "$out/warnings.txt" >&2; exit 1; }
missing=0
if [ -s "$out/output.txt" ] || [ -s "$out/warnings.txt" ]; then
  sed "s|^$root/||" "$out/output.txt" "$out/warnings.txt" | sort -u >&2  # an inherited member is named several times
  missing=1
fi

headers=$(find include/swarmflow -name '*.hpp' | wc -l)
read=$(grep -c 'kind="file"' "$out/xml/index.xml" || true)
if [ "$headers" -eq 0 ] || [ "$read" -ne "$headers" ]; then
  echo "doxygen read $read of $headers headers" >&2
  exit 1
fi
# Doxygen 1.9.4 does not warn about enumerators and namespaces. In its XML the description of a namespace is less deeply
# indented than those of its members.
awk '/<compoundname>/ { split($0, part, /[<>]/); compound = part[3] }
     /<enumvalue / { inside = 1; described = 0; name = "" }
     inside && /<name>/ { split($0, part, /[<>]/); name = part[3] }
     /<para>/ { described = 1 }
     /<\/enumvalue>/ { if (!described) { print "enumerator " compound "::" name " is not documented"; missing = 1 }
                       inside = 0 }
     /^    <briefdescription>/ { described = 0 }
     /^    <\/briefdescription>/ && FILENAME ~ /\/namespaceswarm[^\/]*$/ && !described {
       print "namespace " compound " is not documented"; missing = 1 }
     END { exit missing }' "$out"/xml/namespaceswarm*.xml "$out"/xml/class*.xml "$out"/xml/struct*.xml >&2 || missing=1
[ "$missing" -eq 0 ] && echo "$headers headers, all of their public names documented"
exit "$missing"
