// SPDX-License-Identifier: BSD-3-Clause
#include "centre_index.hpp"

#include <algorithm>
#include <vector>

// FLANN's headers do not include all that they use: the order matters.
// clang-format off
#include <flann/algorithms/dist.h>
#include <flann/util/matrix.h>
#include <flann/util/random.h>
#include <flann/algorithms/center_chooser.h>
#include <flann/algorithms/hierarchical_clustering_index.h>
// clang-format on

#include "distances.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {

/// FLANN's distance type: an element is a whole descriptor, a vector has one of them.
struct DescriptorDistance {
  using ElementType = Descriptor;
  using ResultType = int;

  std::uint64_t seed = 1;
  int (*kernel)(const Descriptor&, const Descriptor&) = distance_kernels().of_two;

  int operator()(const Descriptor* a, const Descriptor* b, std::size_t, int = -1) const { return kernel(*a, *b); }
};

}  // namespace holdfast::flann_plugin

/// Draws without putting back, as FLANN's own does, but from the seed that the distance carries.
template <>
class flann::RandomCenterChooser<holdfast::flann_plugin::DescriptorDistance>
    : public flann::CenterChooser<holdfast::flann_plugin::DescriptorDistance> {
 public:
  using Distance = holdfast::flann_plugin::DescriptorDistance;
  using Points = std::vector<holdfast::Descriptor*>;

  RandomCenterChooser(const Distance& distance, const Points& points)
      : CenterChooser<Distance>(distance, points), random_(distance.seed) {}

  void operator()(int wanted, int* indices, int count, int* centres, int& found) override {
    std::vector<int> rest(indices, indices + count);
    found = 0;
    while (found < wanted && !rest.empty()) {
      const std::uint32_t drawn = random_.below(static_cast<std::uint32_t>(rest.size()));
      const int candidate = rest[drawn];
      rest[drawn] = rest.back();
      rest.pop_back();
      const bool is_new =
          std::none_of(centres, centres + found, [&](int centre) { return *points_[centre] == *points_[candidate]; });
      if (is_new) centres[found++] = candidate;
    }
  }

 private:
  holdfast::Random random_;
};

namespace holdfast::flann_plugin {

namespace {

constexpr int branching = 32;
constexpr int trees = 1;
constexpr int leaf_size = 32;
constexpr float rebuild_growth = 2.0F;

}  // namespace

struct CentreIndex::Tree {
  Tree(Descriptor& first, std::uint64_t seed)
      : index(flann::Matrix<Descriptor>(&first, 1, 1),
              flann::HierarchicalClusteringIndexParams(branching, flann::FLANN_CENTERS_RANDOM, trees, leaf_size),
              DescriptorDistance{.seed = seed}) {
    index.buildIndex();
  }

  flann::HierarchicalClusteringIndex<DescriptorDistance> index;
};

CentreIndex::CentreIndex(std::uint64_t seed, int checks) : seed_(seed), checks_(checks) {}

CentreIndex::~CentreIndex() = default;
CentreIndex::CentreIndex(CentreIndex&& other) noexcept = default;
CentreIndex& CentreIndex::operator=(CentreIndex&& other) noexcept = default;

std::uint32_t CentreIndex::add(const Descriptor& centre) {
  centres_.push_back(centre);
  if (tree_)
    tree_->index.addPoints(flann::Matrix<Descriptor>(&centres_.back(), 1, 1), rebuild_growth);
  else
    tree_ = std::make_unique<Tree>(centres_.back(), seed_);
  return size() - 1;
}

std::size_t CentreIndex::find(const Descriptor& descriptor, std::span<std::uint32_t> nearest) const {
  if (!tree_ || nearest.empty()) return 0;
  flann::KNNSimpleResultSet<int> results(nearest.size());
  tree_->index.findNeighbors(results, &descriptor, flann::SearchParams(checks_));
  constexpr std::size_t most = 64;
  std::size_t numbers[most];
  int distances[most];
  const std::size_t count = std::min({results.size(), nearest.size(), most});
  results.copy(numbers, distances, count);
  for (std::size_t i = 0; i < count; ++i) nearest[i] = static_cast<std::uint32_t>(numbers[i]);
  return count;
}

}  // namespace holdfast::flann_plugin
