// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/abi.hpp"

#include <gmock/gmock.h>

#include <cstring>

namespace holdfast {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Abi, FitsItself) { EXPECT_THAT(abi_differences(compiled_abi(), compiled_abi()), IsEmpty()); }

TEST(Abi, NamesBothSidesOfEveryDifference) {
  AbiRecord program = compiled_abi();
  program.eigen_alignment = 16;
  program.opencv_version = 40600;
  AbiRecord plugin = program;
  plugin.eigen_alignment = 32;
  plugin.opencv_version = 40501;
  EXPECT_THAT(abi_differences(program, plugin),
              ElementsAre("Eigen alignment: program 16, plugin 32", "OpenCV version: program 4.6.0, plugin 4.5.1"));
}

TEST(Abi, EveryFieldCounts) {
  const auto differs = [](auto change) {
    AbiRecord plugin = compiled_abi();
    change(plugin);
    return abi_differences(compiled_abi(), plugin).size();
  };
  EXPECT_EQ(differs([](AbiRecord& r) { r.magic ^= 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.record_size += 8; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { std::strcpy(r.holdfast_version, "99.0"); }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.cpp_standard += 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.eigen_alignment *= 2; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.eigen_version += 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.opencv_version += 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.compiler_abi += 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.new_string_abi ^= 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.eigen_static_alignment += 8; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.eigen_index_size /= 2; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.eigen_row_major ^= 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.debug_containers ^= 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.sanitizers ^= 1; }), 1U);
  EXPECT_EQ(differs([](AbiRecord& r) { r.compiler[0] = 'X'; }), 0U) << "compilers of one ABI fit";
}

TEST(Abi, ARecordOfAnotherSizeStillTellsItsVersion) {
  AbiRecord plugin = compiled_abi();
  plugin.record_size = 56;
  std::strcpy(plugin.holdfast_version, "0.0.9");
  EXPECT_THAT(abi_differences(compiled_abi(), plugin),
              ElementsAre(HasSubstr("Holdfast version: program " HOLDFAST_VERSION ", plugin 0.0.9"),
                          HasSubstr("size of the ABI record")));
}

TEST(Abi, DoesNotReadBeyondAnUnfinishedVersion) {
  AbiRecord plugin = compiled_abi();
  std::memset(plugin.holdfast_version, 'x', sizeof plugin.holdfast_version);
  EXPECT_THAT(abi_differences(compiled_abi(), plugin), ElementsAre(HasSubstr("plugin xxxxxxxxxxxxxxxx")));
}

}  // namespace
}  // namespace holdfast
