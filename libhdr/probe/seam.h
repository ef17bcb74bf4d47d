#pragma once
// Where one photograph of the sphere gives way to the next.
namespace hdr {

/// kFeather: by their places in the photographs, faded into each other along the border. kCut: a graph cut [Kwatra03]
/// on a lat-long of at most 640 columns, along which they differ least: what moved is shown whole or not at all where
/// there is a way around it.
enum class Seam { kFeather, kCut };

}  // namespace hdr
