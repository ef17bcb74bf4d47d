#pragma once
// The public API on one screen: photographs in, light out.
//
//   const auto shots       = hdr::read_bracket(files);
//   const auto alignment   = hdr::align(shots, hdr::provisional_response(shots));
//   const auto calibration = hdr::calibrate_debevec_malik(shots, alignment.ref_from_photo());
//   const auto merged      = hdr::merge(shots, alignment, calibration.response);
//   const auto ball        = hdr::find_ball(merged.map.rgb);
//   const auto probe       = hdr::unwrap(merged.map, ball.value().ball, hdr::LatLong{{2048, 1024}}, {2048, 1024});
//   hdr::write_map("probe.exr", probe);
//   const auto sh          = hdr::project(probe.rgb, hdr::LatLong{probe.size()}, 2);
//   const auto light       = hdr::Environment::from_probe(probe, hdr::LatLong{probe.size()});
//   hdr::write_map("render.exr", hdr::render(hdr::spheres_on_plane(), light).picture);
#include "libhdr/core/color.h"      // luminance, sRGB
#include "libhdr/core/error.h"      // Error: file, fact, remedy
#include "libhdr/core/image.h"      // Image owns, View borrows
#include "libhdr/core/mosaic.h"     // a raw photograph
#include "libhdr/core/parallel.h"   // set_threads, for_rows, reduce_rows
#include "libhdr/core/photo.h"      // Photo: codes; Bracket
#include "libhdr/core/photometry.h"  // cd/m^2 from the exposure
#include "libhdr/core/photo_samples.h"  // a small part of its codes
#include "libhdr/core/radiance.h"   // RadianceMap: linear light; Provenance
#include "libhdr/core/rows.h"       // pictures as rows that pass by
#include "libhdr/core/sphere.h"     // axes and pixel conventions, once
#include "libhdr/core/version.h"

#include "libhdr/io/bracket.h"        // read_bracket: SHOTS with their exposures
#include "libhdr/io/bracket_report.h"  // what a bracket covers and lacks
#include "libhdr/io/demosaic.h"       // three colours from a Bayer mosaic
#include "libhdr/io/dng.h"            // raw photographs in files
#include "libhdr/io/exposure_list.h"  // exposures from a text file
#include "libhdr/io/map_scale.h"      // what a map that was written says: its unit, its camera's field
#include "libhdr/io/read.h"           // read_photo, read_map, read_info
#include "libhdr/io/write.h"          // write_map, write_picture, write_photo
#include "libhdr/io/write_layers.h"   // an EXR with more layers

#include "libhdr/response/calibrate.h"  // calibrate_debevec_malik, provisional_response
#include "libhdr/response/estimate_noise.h"  // the camera's noise, from the bracket
#include "libhdr/response/expose.h"     // expose: radiance -> photograph
#include "libhdr/response/fragments.h"   // the data behind a response
#include "libhdr/response/response.h"   // g(Z) = ln f^-1(Z), and its file
#include "libhdr/response/response_file.h"  // the files of others, too

#include "libhdr/align/align.h"  // ref_from_photo of every shot
#include "libhdr/align/warp.h"   // a registered shot as a photograph
#include "libhdr/merge/deghost.h"  // things that moved between the shots
#include "libhdr/merge/drift.h"  // light that changed between the shots
#include "libhdr/merge/merge.h"  // bracket -> radiance map

#include "libhdr/filter/blur.h"     // Gaussian and motion blur, on the plane and on the sphere
#include "libhdr/filter/compare.h"  // how far apart two maps are
#include "libhdr/filter/fuse.h"     // a picture straight from the shots
#include "libhdr/filter/resize.h"
#include "libhdr/filter/tonemap.h"  // for looking

#include "libhdr/probe/ball_normal.h"  // of a ball in a photograph
#include "libhdr/probe/ball_views.h"  // several views of one ball become one sphere
#include "libhdr/probe/convention.h"  // which way round others have the sphere
#include "libhdr/probe/find_ball.h"   // where the mirror ball is
#include "libhdr/probe/find_image_circle.h"  // where a fisheye's picture ends
#include "libhdr/probe/find_level.h"  // which way is up
#include "libhdr/probe/fisheye_pair.h"  // two opposite lenses as one sphere
#include "libhdr/probe/photograph.h"  // what a camera sees in an environment
#include "libhdr/probe/photographer.h"  // and who stands behind it
#include "libhdr/probe/reflectance.h"  // what a mirror ball does not give back
#include "libhdr/probe/projection.h"  // pixels <-> directions
#include "libhdr/probe/seam.h"  // where one photograph gives way to the next
#include "libhdr/probe/stitch.h"  // photographs from one point as one sphere
#include "libhdr/probe/test_chart.h"  // a sphere that says which way round it is
#include "libhdr/probe/unwrap.h"      // from one projection to another
#include "libhdr/probe/vignetting.h"  // corners that a lens leaves darker

#include "libhdr/light/cube.h"         // six faces
#include "libhdr/light/diffuse_ball.h"  // a matt ball as a light meter
#include "libhdr/light/environment.h"  // sample / pdf / invert
#include "libhdr/light/frequency_prefilter.h"  // the same for broad lobes, in frequency space
#include "libhdr/light/horizontal_irradiance.h"  // what a lux meter would read
#include "libhdr/light/lights.h"       // N directional lights
#include "libhdr/light/lights_text.h"  // for USD and Radiance
#include "libhdr/light/prefilter.h"    // for real-time engines
#include "libhdr/light/restore_clipped.h"  // suns that every shot clipped
#include "libhdr/light/sh.h"           // project, irradiance, rotated
#include "libhdr/light/sh_fit.h"       // least largest error of the irradiance
#include "libhdr/light/sh_latlong.h"   // tabulated
#include "libhdr/light/sh_reflect.h"   // reflection in frequency space
#include "libhdr/light/sh_text.h"      // for C, three.js, Filament, Unity
#include "libhdr/light/sh_window.h"    // against ringing
#include "libhdr/light/split_lights.h" // compact lights and the soft rest

#include "libhdr/render/colour_chart.h"  // a grey ball, a colour chart and a chrome ball
#include "libhdr/render/bounds.h"     // the box around a scene
#include "libhdr/render/composite.h"  // objects into a photograph
#include "libhdr/render/framing.h"  // where a camera must stand to see all of a scene
#include "libhdr/render/layers.h"  // albedo and depth
#include "libhdr/render/plane_pose.h"  // a camera from a rectangle on the ground
#include "libhdr/render/prt.h"  // a mesh's transfer: lit by any probe at once
#include "libhdr/render/render.h"  // a picture of a scene lit by a probe
#include "libhdr/render/scene.h"
#include "libhdr/render/scene_file.h"  // OBJ, PLY, glTF
