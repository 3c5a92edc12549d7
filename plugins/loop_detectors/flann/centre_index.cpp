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

#include "holdfast/core/random.hpp"

namespace holdfast::flann_plugin {

/// FLANN's distance type. A vector is a whole descriptor, which FLANN knows by the address of its first unit only.
struct DescriptorDistance {
  using ElementType = Descriptor256;
  using ResultType = float;

  std::uint64_t seed;
  DescriptorDistances distances;

  float operator()(const Descriptor256* a, const Descriptor256* b, std::size_t, float = -1.0F) const {
    return distances.of_two(a, b);
  }
};

}  // namespace holdfast::flann_plugin

/// Draws without putting back, as FLANN's own does, but from the seed that the distance carries.
template <>
class flann::RandomCenterChooser<holdfast::flann_plugin::DescriptorDistance>
    : public flann::CenterChooser<holdfast::flann_plugin::DescriptorDistance> {
 public:
  using Distance = holdfast::flann_plugin::DescriptorDistance;
  using Points = std::vector<holdfast::Descriptor256*>;

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
      const bool is_new = std::none_of(centres, centres + found, [&](int centre) {
        return distance_(points_[centre], points_[candidate], 1) <= 0.0F;
      });
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
  Tree(Descriptor256* first, const DescriptorDistances& distances, std::uint64_t seed)
      : index(flann::Matrix<Descriptor256>(first, 1, 1),
              flann::HierarchicalClusteringIndexParams(branching, flann::FLANN_CENTERS_RANDOM, trees, leaf_size),
              DescriptorDistance{seed, distances}) {
    index.buildIndex();
  }

  flann::HierarchicalClusteringIndex<DescriptorDistance> index;
};

CentreIndex::CentreIndex(const DescriptorType& type, std::uint64_t seed, int checks)
    : distances_(type), units_(DescriptorView::units_of(type)), seed_(seed), checks_(checks) {}

CentreIndex::~CentreIndex() = default;
CentreIndex::CentreIndex(CentreIndex&& other) noexcept = default;
CentreIndex& CentreIndex::operator=(CentreIndex&& other) noexcept = default;

std::uint32_t CentreIndex::add(const Descriptor256* centre) {
  const std::uint32_t number = size_++;
  if (number / rows_of_chunk == chunks_.size())
    chunks_.push_back(std::make_unique<Descriptor256[]>(rows_of_chunk * units_));
  move(number, centre);
  if (tree_)
    tree_->index.addPoints(flann::Matrix<Descriptor256>(row(number), 1, 1), rebuild_growth);
  else
    tree_ = std::make_unique<Tree>(row(number), distances_, seed_);
  return number;
}

void CentreIndex::move(std::uint32_t number, const Descriptor256* centre) { std::copy_n(centre, units_, row(number)); }

std::size_t CentreIndex::find(const Descriptor256* descriptor, std::span<std::uint32_t> nearest) const {
  if (!tree_ || nearest.empty()) return 0;
  flann::KNNSimpleResultSet<float> results(nearest.size());
  tree_->index.findNeighbors(results, descriptor, flann::SearchParams(checks_));
  constexpr std::size_t most = 64;
  std::size_t numbers[most];
  float distances[most];
  const std::size_t count = std::min({results.size(), nearest.size(), most});
  results.copy(numbers, distances, count);
  for (std::size_t i = 0; i < count; ++i) nearest[i] = static_cast<std::uint32_t>(numbers[i]);
  return count;
}

}  // namespace holdfast::flann_plugin
