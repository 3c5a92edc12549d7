// SPDX-License-Identifier: BSD-3-Clause
// Other programs read the files of the surface: assimp and the validator of Khronos the meshes, OpenCV and yaml-cpp the
// grid map. OctoMap's own library reads the octrees in free_space_test.cpp.
#include <gmock/gmock.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "holdfast/core/trajectory.hpp"
#include "holdfast/surface/free_space.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "support/npm_tools.hpp"
#ifdef HOLDFAST_TEST_WITH_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

/// A ball of triangles, red on one side and green on the other, with classes.
TriangleMesh ball() {
  constexpr int rows = 12, columns = 24;
  TriangleMesh mesh;
  mesh.classes = {"background", "ball"};
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double polar = M_PI * row / rows, turn = 2.0 * M_PI * column / columns;
      const Eigen::Vector3d n(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
      MeshVertex vertex{(0.5 * n + Eigen::Vector3d(1, 2, 3)).cast<float>(), n.cast<float>(), 200, 30, 90, 1};
      if (n.x() < 0.0) std::swap(vertex.red, vertex.green);
      mesh.vertices.push_back(vertex);
    }
  const auto at = [](int row, int column) { return static_cast<std::uint32_t>(row * columns + column % columns); };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (row > 0) mesh.triangles.push_back({at(row, column), at(row, column + 1), at(row + 1, column)});
      if (row < rows - 1) mesh.triangles.push_back({at(row, column + 1), at(row + 1, column + 1), at(row + 1, column)});
    }
  return mesh;
}

class SurfaceReadersTest : public testing::Test {
 protected:
  SurfaceReadersTest() { fs::create_directories(folder_); }
  ~SurfaceReadersTest() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path write(const std::string& format) const {
    fs::path file = folder_ / ("ball." + format);
    write_mesh(file, ball());
    return file;
  }

  fs::path folder_ = fs::temp_directory_path() / ("surface_readers_test." + std::to_string(getpid()));
};

#ifdef HOLDFAST_TEST_WITH_ASSIMP
/// sRGB to linear (IEC 61966-2-1), as glTF has colours.
double linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

TEST_F(SurfaceReadersTest, AssimpReadsEveryFormatOfMeshes) {
  const TriangleMesh mesh = ball();
  for (const std::string& format : mesh_formats()) {
    SCOPED_TRACE(format);
    const bool is_gltf = format == "glb";
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(write(format).string(), aiProcess_PreTransformVertices);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 1U);
    const aiMesh& read = *scene->mMeshes[0];
    ASSERT_EQ(read.mNumFaces, mesh.triangles.size());
    ASSERT_TRUE(read.HasNormals());
    ASSERT_TRUE(read.HasVertexColors(0));
    for (unsigned i = 0; i < read.mNumFaces; ++i) {
      ASSERT_EQ(read.mFaces[i].mNumIndices, 3U);
      for (unsigned k = 0; k < 3; ++k) {
        const MeshVertex& own = mesh.vertices[mesh.triangles[i][k]];
        const unsigned index = read.mFaces[i].mIndices[k];
        const aiVector3D place = read.mVertices[index], normal = read.mNormals[index];
        const aiColor4D colour = read.mColors[0][index];
        const float up = is_gltf ? -1.0F : 1.0F;  // half a turn about x
        EXPECT_LT((Eigen::Vector3f(place.x, up * place.y, up * place.z) - own.position).norm(), 1e-4F);
        EXPECT_LT((Eigen::Vector3f(normal.x, up * normal.y, up * normal.z) - own.normal).norm(), 1e-3F);
        const auto expected = [&](int value) { return is_gltf ? linear(value / 255.0) : value / 255.0; };
        EXPECT_NEAR(colour.r, expected(own.red), 1e-3);
        EXPECT_NEAR(colour.g, expected(own.green), 1e-3);
        EXPECT_NEAR(colour.b, expected(own.blue), 1e-3);
      }
    }
  }
}
#endif

TEST_F(SurfaceReadersTest, TheValidatorOfKhronosFindsNothingWrongWithGlb) {
  const test::NpmTools tools(HOLDFAST_TEST_NPM_FOLDER, {"gltf-validator@2.0.0-dev.3.10"});
  if (!tools.trouble().empty()) GTEST_SKIP() << tools.trouble();
  const auto run = [&](const std::string& command) { return tools.run(command, folder_ / "output"); };
  const std::optional<std::string> said = run("node '" HOLDFAST_TEST_VALIDATOR "' '" + write("glb").string() + "'");
  ASSERT_TRUE(said);
  const nlohmann::json report = nlohmann::json::parse(*said);
  EXPECT_EQ(report["errors"], 0);
  EXPECT_EQ(report["warnings"], 0);
  EXPECT_THAT(report["messages"], IsEmpty()) << *said;
  EXPECT_EQ(report["vertices"], ball().vertices.size());
  EXPECT_EQ(report["triangles"], ball().triangles.size());

  // And it would say so.
  std::string bytes = mesh_glb(ball());
  const std::size_t at = bytes.find("\"VEC4\"");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 4] = '2';
  write_file_atomically(folder_ / "ball.glb", bytes);
  const std::optional<std::string> damaged =
      run("node '" HOLDFAST_TEST_VALIDATOR "' '" + (folder_ / "ball.glb").string() + "'");
  ASSERT_TRUE(damaged);
  EXPECT_GT(nlohmann::json::parse(*damaged)["errors"], 0);
}

TEST_F(SurfaceReadersTest, OpenCvAndYamlCppReadTheGridMap) {
  GridMap map;
  map.width = 3, map.height = 2;
  map.resolution = 0.05;
  map.origin = {-1.25, 2.5};
  map.cells = {Occupancy::free, Occupancy::occupied, Occupancy::unknown,  // the lowest row
               Occupancy::free, Occupancy::free,     Occupancy::occupied};
  write_file_atomically(folder_ / "map.pgm", grid_map_pgm(map));
  write_file_atomically(folder_ / "map.yaml", grid_map_yaml(map, "map.pgm"));
  const YAML::Node yaml = YAML::LoadFile((folder_ / "map.yaml").string());
  const cv::Mat image = cv::imread((folder_ / yaml["image"].as<std::string>()).string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.size(), cv::Size(3, 2));
  ASSERT_EQ(image.type(), CV_8UC1);
  EXPECT_EQ(yaml["resolution"].as<double>(), 0.05);
  EXPECT_THAT(yaml["origin"].as<std::vector<double>>(), testing::ElementsAre(-1.25, 2.5, 0.0));
  const double free_below = yaml["free_thresh"].as<double>(), occupied_above = yaml["occupied_thresh"].as<double>();
  const bool negate = yaml["negate"].as<int>() != 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      // As map_server interprets a pixel; the first row of the image is the highest.
      const double value = image.at<std::uint8_t>(1 - y, x) / 255.0, p = negate ? value : 1.0 - value;
      const Occupancy state = p > occupied_above ? Occupancy::occupied
                              : p < free_below   ? Occupancy::free
                                                 : Occupancy::unknown;
      EXPECT_EQ(state, map.at(x, y)) << x << ", " << y;
    }
}

}  // namespace
}  // namespace holdfast
