// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "holdfast/geometry/pinhole.hpp"

/// Traits by which the searches of this folder read a caller's types. Specialise them beside the type; nothing is
/// copied or converted. Those of Holdfast are in matching/frame_features.hpp and matching/point_block.hpp, an example
/// for other types is examples/geometry_alone.cpp. The searches need Eigen alone.
namespace holdfast::matching {

using geometry::Pinhole;

/// Reads the features of one image. A specialisation for a type View has these static functions; `feature` counts from
/// 0, coordinates are undistorted pixels of the full image:
///
///     using Descriptors = ...;                            // a cheap handle such as a span; see DescriptorTraits
///     std::size_t size(const View&);
///     float x(const View&, feature), y(const View&, feature);
///     float right_x(const View&, feature);                // column in the right image, NaN = none
///     float angle(const View&, feature);                  // orientation [rad]
///     int octave(const View&, feature);                   // pyramid level, 0 = full resolution
///     Descriptors descriptors(const View&);
///     void near(const View&, float x, float y, float radius, std::vector<std::uint32_t>& found);
///                                                         // appends features within a square window, in a fixed order
///     bool covers(const View&, float x, float y);         // whether the pixel is inside the image
///     Pinhole camera(const View&);
///     int predict_level(const View&, double max_distance, double distance);  // octave of a point at this distance
///     float scale(const View&, int level);                // size of a pixel of this level [px of the full image]
///     float inverse_sigma2(const View&, int level);       // inverse variance of a coordinate [1/px^2]
template <class View>
struct ViewTraits;

/// Reads points in space that are searched for. A specialisation for a type Points has these static functions:
///
///     std::size_t size(const Points&);
///     Eigen::Vector3f position(const Points&, i);         // world [m]
///     Eigen::Vector3f direction(const Points&, i);        // unit mean of the directions from camera to point, world
///     float min_distance(const Points&, i), max_distance(const Points&, i);  // from which it was recognisable [m]
template <class Points>
struct PointTraits;

/// Computes distances of descriptors. A specialisation for a handle type Descriptors (binary, floating-point, any) has:
///
///     using Distance = ...;                               // an arithmetic type; smaller is more alike
///     std::size_t size(const Descriptors&);
///     void distances(const Descriptors& queries, std::uint32_t query, const Descriptors& references,
///                    std::span<const std::uint32_t> candidates, Distance* distances);
///                                                         // distances[k] = query to references[candidates[k]]
template <class Descriptors>
struct DescriptorTraits;

/// Handle to descriptors with DescriptorTraits.
template <class Descriptors>
concept DescriptorSet = requires(const Descriptors& set, std::span<const std::uint32_t> candidates,
                                 typename DescriptorTraits<Descriptors>::Distance* distances) {
  { DescriptorTraits<Descriptors>::size(set) } -> std::convertible_to<std::size_t>;
  DescriptorTraits<Descriptors>::distances(set, std::uint32_t{}, set, candidates, distances);
};

/// Features of one image with ViewTraits.
template <class View>
concept FeatureView = DescriptorSet<typename ViewTraits<View>::Descriptors> &&
    requires(const View& view, std::uint32_t feature, std::vector<std::uint32_t>& found) {
  { ViewTraits<View>::size(view) } -> std::convertible_to<std::size_t>;
  { ViewTraits<View>::x(view, feature) } -> std::convertible_to<float>;
  { ViewTraits<View>::y(view, feature) } -> std::convertible_to<float>;
  { ViewTraits<View>::right_x(view, feature) } -> std::convertible_to<float>;
  { ViewTraits<View>::angle(view, feature) } -> std::convertible_to<float>;
  { ViewTraits<View>::octave(view, feature) } -> std::convertible_to<int>;
  ViewTraits<View>::near(view, 0.0F, 0.0F, 0.0F, found);
  { ViewTraits<View>::covers(view, 0.0F, 0.0F) } -> std::convertible_to<bool>;
  { ViewTraits<View>::camera(view) } -> std::convertible_to<Pinhole>;
  { ViewTraits<View>::predict_level(view, 1.0, 1.0) } -> std::convertible_to<int>;
  { ViewTraits<View>::scale(view, 0) } -> std::convertible_to<float>;
  { ViewTraits<View>::inverse_sigma2(view, 0) } -> std::convertible_to<float>;
};

/// Set of 3-D points with PointTraits.
template <class Points>
concept PointSet = requires(const Points& points, std::uint32_t i) {
  { PointTraits<Points>::size(points) } -> std::convertible_to<std::size_t>;
  { PointTraits<Points>::position(points, i) } -> std::convertible_to<Eigen::Vector3f>;
  { PointTraits<Points>::direction(points, i) } -> std::convertible_to<Eigen::Vector3f>;
  { PointTraits<Points>::min_distance(points, i) } -> std::convertible_to<float>;
  { PointTraits<Points>::max_distance(points, i) } -> std::convertible_to<float>;
};

/// Type of the distance between two descriptors of a set.
template <DescriptorSet Descriptors>
using DistanceOf = typename DescriptorTraits<Descriptors>::Distance;

}  // namespace holdfast::matching
