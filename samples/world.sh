# Sourced: get_world FILE fetches a real place, 17 stops deep: an HDR map (CC0, from Poly Haven) out of Debian's blender-data.
# Needs samples/packages.sh.
get_world() {
  local world=$1 package
  package=$(dirname "$world")/blender-data
  mkdir -p "$package"
  (cd "$package" && apt-get -qq download blender-data 2>/dev/null) ||
    { as_root apt-get -qq update && (cd "$package" && apt-get -qq download blender-data); }
  dpkg-deb -x "$package"/blender-data_*.deb "$package"
  cp "$package/usr/share/blender/datafiles/studiolights/world/city.exr" "$world"
  rm -rf "$package"
}
