// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/mesh_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/surface/class_colours.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  for (const Eigen::Vector3f& corner :
       {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, 0, 1)})
    mesh.vertices.push_back({corner, {}, 255, 128, 0});
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  compute_normals(mesh);
  return mesh;
}

class MeshFilesTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& content) {
    const std::filesystem::path file = folder_ / "mesh.ply";
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
  std::string error_of(const std::string& content) {
    try {
      read_mesh(write(content));
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  MeshFilesTest() { std::filesystem::create_directories(folder_); }
  ~MeshFilesTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("mesh_files_test." + std::to_string(getpid()));
};

TEST_F(MeshFilesTest, ReadsWhatItWrites) {
  const TriangleMesh mesh = tetrahedron();
  const TriangleMesh found = read_mesh(write(mesh_ply(mesh)));
  ASSERT_EQ(found.vertices.size(), 4U);
  EXPECT_EQ(found.triangles, mesh.triangles);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(found.vertices[i].position, mesh.vertices[i].position);
    EXPECT_EQ(found.vertices[i].normal, mesh.vertices[i].normal);
    EXPECT_EQ(found.vertices[i].green, 128);
  }
}

TEST_F(MeshFilesTest, KeepsTheClassesOfVertices) {
  TriangleMesh mesh = tetrahedron();
  mesh.vertices[2].label = 1;
  mesh.classes = {"background", "chair\nelement face 9"};
  const TriangleMesh found = read_mesh(write(mesh_ply(mesh)));
  EXPECT_EQ(found.vertices[2].label, 1);
  EXPECT_EQ(found.vertices[0].label, MeshVertex::unknown_class);
  EXPECT_EQ(found.triangles, mesh.triangles);

  mesh.vertices[3].label = 0;
  colour_by_class(mesh);
  EXPECT_EQ(mesh.vertices[2].blue, 255);
  EXPECT_EQ(mesh.vertices[3].red, 200);
  EXPECT_NE(mesh.vertices[0].red, mesh.vertices[3].red) << "unknown and background";
}

TEST_F(MeshFilesTest, ReadsTextAndPolygonsOfOtherPrograms) {
  const TriangleMesh square = read_mesh(
      write("ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 4\r\nproperty double x\r\nproperty double y\r\n"
            "property double z\r\nproperty float quality\r\nelement face 1\r\nproperty list uchar int vertex_index\r\n"
            "end_header\r\n0 0 0 9\r\n1 0 0 9\r\n1 1 0 9\r\n0 1 0 9\r\n4 0 1 2 3\r\n"));
  EXPECT_EQ(square.triangles.size(), 2U);
  EXPECT_NEAR(square.area(), 1.0, 1e-12);
}

TEST_F(MeshFilesTest, ReadsBigEndianNumbers) {
  std::string data =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  const std::string one("\x3F\x80\0\0", 4), zero(4, '\0');
  data += zero + zero + zero + one + zero + zero + zero + one + zero;
  data += std::string("\x03\0\0\0\1\0\2", 7);
  EXPECT_NEAR(read_mesh(write(data)).area(), 0.5, 1e-12);
}

TEST_F(MeshFilesTest, RefusesDamagedFiles) {
  const std::string good = mesh_ply(tetrahedron());
  EXPECT_THAT(error_of("solid"), HasSubstr("is no PLY file"));
  EXPECT_THAT(error_of(good.substr(0, 40)), HasSubstr("its header has no end"));
  EXPECT_THAT(error_of(good.substr(0, good.size() - 1)), HasSubstr("ends early"));
  std::string far_corner = good;
  far_corner[far_corner.size() - 4] = 9;
  EXPECT_THAT(error_of(far_corner), HasSubstr("has a face with the vertex 9, and it has 4 vertices"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement vertex 99999999\nproperty float x\nend_header\n1\n"),
              HasSubstr("states 99999999 elements 'vertex', more than it has"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                       "property float z\nend_header\n1 1 1\n"),
              HasSubstr("has no triangle"));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                       "property float z\nend_header\n1 nan 1\n"),
              HasSubstr("not finite"));
}

TEST_F(MeshFilesTest, WritesObjWithOneLinePerVertexNormalAndFace) {
  const std::string text = mesh_obj(tetrahedron());
  EXPECT_THAT(text, HasSubstr("v 1.00000 0.00000 0.00000 1.0000 0.5020 0.0000\n"));
  EXPECT_THAT(text, HasSubstr("f 2//2 3//3 4//4\n"));
}

TEST_F(MeshFilesTest, WritesGlbAsGltf2Requires) {
  const std::string bytes = mesh_glb(tetrahedron());
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number(4), 2U);
  EXPECT_EQ(number(8), bytes.size());
  const std::uint32_t json = number(12);
  EXPECT_EQ(json % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(number(20 + json), 4U * 32 + 4U * 12);  // vertices and indices
  EXPECT_EQ(bytes.substr(24 + json, 4), std::string("BIN\0", 4));
  EXPECT_EQ(bytes.size(), 28U + json + 4 * 32 + 4 * 12);
  EXPECT_THAT(bytes.substr(20, json), HasSubstr("\"max\":[1.0,1.0,1.0],\"min\":[0.0,0.0,0.0]"));
  EXPECT_THROW(mesh_glb({}), Error);
}

TEST_F(MeshFilesTest, ChoosesTheFormatByTheEnding) {
  for (const std::string& format : mesh_formats()) write_mesh(folder_ / ("a." + format), tetrahedron());
  EXPECT_EQ(read_mesh(folder_ / "a.ply").triangles.size(), 4U);
  EXPECT_THROW(write_mesh(folder_ / "a.stl", tetrahedron()), InputError);
}

}  // namespace
}  // namespace holdfast
