#pragma once
// Small vectors and matrices are Eigen's. Name the type when storing a result (`Vec3 d = a + b`): with `auto` an
// expression would keep references to temporaries.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hdr {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Rgb = Eigen::Array3d;   ///< a colour in double, for sums
using Rgbf = Eigen::Array3f;  ///< a colour in float, for pixels

}  // namespace hdr
