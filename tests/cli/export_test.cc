// SPDX-License-Identifier: Apache-2.0
// `physpring export` and `physpring interior` as a user sees them.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/mesh_files.h"
#include "tests/support/program.h"
#include "tests/support/small_twin.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

class Export : public testing::Test {
 protected:
  Export() { WriteTwin(SmallTwin(2), TwinPath()); }

  std::string TwinPath() const { return folder_.File("block.twin.npz"); }
  std::string Folder() const { return folder_.File("out"); }
  ProgramResult Run(std::vector<std::string> more) const {
    more.insert(more.begin(), {"export", TwinPath(), "-o", Folder()});
    return RunProgram(more);
  }
  bool Wrote() const { return std::filesystem::exists(Folder()); }

  TemporaryFolder folder_;
};

TEST_F(Export, WritesAFolderAndTellsWhatIsInIt) {
  const ProgramResult result = Run({});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(result.errors.find("warning: " + TwinPath() + ": the twin does not say what ground"),
            0u)
      << result.errors;
  EXPECT_NE(result.output.find("level0.xml: 40 nodes"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("level1.xml: 20 nodes"), std::string::npos) << result.output;
  for (const char* name :
       {"README.md", "level0.xml", "level1.xml", "scene.xml", "scene_level1.xml"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(Folder() + "/" + name)) << name;
  }
  const std::string readme = ReadFile(Folder() + "/README.md");
  EXPECT_NE(readme.find("physpring export block.twin.npz -o out\n"), std::string::npos) << readme;
}

TEST_F(Export, TellsWhereMujocosContactsFollowBadly) {
  for (double restitution : {0.5, 0.95}) {
    Twin twin = SmallTwin(1);
    twin.levels[0].system.contact.surface.restitution = restitution;
    WriteTwin(twin, TwinPath());
    for (const char* contact : {"mujoco", "plugin"}) {
      const ProgramResult result = Run({"--contact", contact, "--force"});
      ASSERT_EQ(result.status, 0) << result.errors;
      const bool told = result.errors.find("it bounces (restitution 0.95)") != std::string::npos;
      EXPECT_EQ(told, restitution == 0.95 && contact == std::string("mujoco")) << result.errors;
    }
  }
}

TEST_F(Export, OneLevelHasTheScene) {
  EXPECT_EQ(Run({"--level", "1", "--springs", "flex", "--flexes", "2"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(Folder() + "/level0.xml"));
  EXPECT_NE(ReadFile(Folder() + "/scene.xml").find("level1.xml"), std::string::npos);
}

TEST_F(Export, TellsHowFlexesRound) {
  const ProgramResult result = Run({"--springs", "flex"});
  EXPECT_NE(result.output.find("flexes, rounded: stiffness by"), std::string::npos)
      << result.output;
}

TEST_F(Export, WritesSamplesOfThePosterior) {
  Twin twin = SmallTwin(2);
  const SpringMassSystem& dense = twin.levels[0].system;
  twin.posterior = {Eigen::MatrixXd::Constant(1, dense.spring_count(), 0.2),
                    Eigen::MatrixXd::Zero(1, dense.spring_count()), Eigen::VectorXd::Zero(1),
                    Eigen::MatrixXd::Zero(1, kContactCount), Eigen::MatrixXd(1, 0)};
  WriteTwin(twin, TwinPath());
  const ProgramResult result = Run({"--samples", "2", "--seed", "3"});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_NE(result.output.find("samples of the posterior: sample_0000 to sample_0001"),
            std::string::npos)
      << result.output;
  const auto file = [&](const std::string& name) { return ReadFile(Folder() + "/" + name); };
  EXPECT_NE(file("sample_0000/level1.xml"), file("level1.xml"));
  EXPECT_NE(file("sample_0000/level1.xml"), file("sample_0001/level1.xml"));
  EXPECT_TRUE(std::filesystem::exists(Folder() + "/sample_0001/scene.xml"));
  EXPECT_NE(file("sample_0001/README.md").find("This is sample 1 of seed 3"), std::string::npos);
  const std::string first = file("sample_0000/level0.xml");
  EXPECT_EQ(Run({"--samples", "1", "--seed", "3", "--force"}).status, 0);
  EXPECT_EQ(file("sample_0000/level0.xml"), first) << "whatever other samples there are";
  EXPECT_FALSE(std::filesystem::exists(Folder() + "/sample_0001"));
}

TEST_F(Export, NeedsAPosteriorForSamples) {
  const ProgramResult result = Run({"--samples", "2"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.errors.find("holds no posterior"), std::string::npos) << result.errors;
  EXPECT_FALSE(Wrote());
}

TEST_F(Export, OverwritesOnlyIfForced) {
  EXPECT_EQ(Run({}).status, 0);
  EXPECT_TRUE(FailsWith(Run({}), Folder() + ": exists; --force overwrites"));
  EXPECT_EQ(Run({"--force"}).status, 0);
}

TEST_F(Export, AFailureLeavesNothing) {
  EXPECT_TRUE(FailsWith(Run({"--timestep", "0.5"}), "a time step of 0.5 s is unstable"));
  EXPECT_TRUE(FailsWith(Run({"--level", "2"}), "has no level 2, expected 0 to 1"));
  EXPECT_TRUE(FailsWith(Run({"--name", "a b"}), "name 'a b'"));
  EXPECT_TRUE(FailsWith(Run({"--mesh", "/none.obj"}), "/none.obj: no such file"));
  EXPECT_FALSE(Wrote());
}

TEST_F(Export, BadUsageIsToldAsSuch) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--springs", "rubber"},
                                                    {"--springs", "1"},
                                                    {"--contact", "hard"},
                                                    {"--controllers", "hand"},
                                                    {"--level", "-1"},
                                                    {"--level", "first"},
                                                    {"--flexes", "0"},
                                                    {"--flexes", "3"},
                                                    {"--timestep", "0"},
                                                    {"--name", ""}}) {
    const ProgramResult result = Run(arguments);
    EXPECT_EQ(result.status, 2) << arguments[0];
    EXPECT_NE(result.errors.find(arguments[0]), std::string::npos) << result.errors;
  }
  EXPECT_FALSE(Wrote());
  EXPECT_EQ(Run({"--name", ""}).errors,
            "physpring export: --name: takes a name, not '' (see physpring export --help)\n");
}

// A box around the small twin's particles, 4 mm larger on all sides.
TriangleMesh Box() {
  TriangleMesh box;
  box.vertices.resize(3, 8);
  box.vertices << 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1;
  box.vertices = Eigen::Vector3d(0.088, 0.068, 0.028).asDiagonal() * box.vertices;
  box.vertices.array() -= 0.004;
  for (const std::array<int, 4>& side : {std::array<int, 4>{3, 2, 1, 0},
                                         {4, 5, 6, 7},
                                         {0, 1, 5, 4},
                                         {1, 2, 6, 5},
                                         {2, 3, 7, 6},
                                         {3, 0, 4, 7}}) {
    box.faces.push_back({side[0], side[1], side[2]});
    box.faces.push_back({side[0], side[2], side[3]});
  }
  return box;
}

// The small twin's motion, as seen from outside.
Recording WithoutInterior() {
  Recording recording = RecordingOfMotion(SmallTwin(1), 5);
  recording.interior = Points(3, 0);
  recording.start = Points(3, 34);
  recording.start << recording.points[0], recording.controllers[0];
  recording.rest = recording.start;
  recording.velocity = Points::Zero(3, 32);
  return recording;
}

TEST_F(Export, InteriorFillsAMesh) {
  WriteRecording(WithoutInterior(), folder_.File("swing.npz"));
  WriteObj(Box(), folder_.File("box.obj"));
  const ProgramResult result =
      RunProgram({"interior", folder_.File("swing.npz"), "--mesh", folder_.File("box.obj"),
                  "--spacing", "0.005", "-o", folder_.File("full.npz")});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  const Recording full = ReadRecording(folder_.File("full.npz"));
  EXPECT_EQ(full.point_count(), 32);
  EXPECT_GT(full.interior_count(), 1000);  // of 18 x 14 x 6 points of the lattice
  EXPECT_LE(full.interior_count(), 18 * 14 * 6);
  EXPECT_TRUE(FailsWith(RunProgram({"interior", folder_.File("full.npz"), "--mesh",
                                    folder_.File("box.obj"), "-o", folder_.File("no.npz")}),
                        "has an array 'interior'"));
}

// The camera sees the lower half of the block.
TEST_F(Export, InteriorIsOnTheSurfaceThatNoPointIsOn) {
  Recording recording = WithoutInterior();
  for (Points* points : {&recording.start, &recording.rest}) {
    *points = (Points(3, 22) << points->leftCols(20), points->rightCols(2)).finished();
  }
  for (Points& frame : recording.points) frame = Points(frame.leftCols(20));
  recording.velocity = Points::Zero(3, 20);
  WriteRecording(recording, folder_.File("half.npz"));
  WriteObj(Box(), folder_.File("box.obj"));
  const auto fill = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"interior",  folder_.File("half.npz"),
                                   "--mesh",    folder_.File("box.obj"),
                                   "--spacing", "0.02",
                                   "-o",        folder_.File(name)};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(RunProgram(words).status, 0);
    return ReadRecording(folder_.File(name)).interior;
  };
  const Points inside = fill("inside.npz", {}), all = fill("all.npz", {"--surface"});
  const auto on_top = [](const Points& points) { return (points.row(2).array() > 0.024).count(); };
  EXPECT_EQ(on_top(inside), 0);
  EXPECT_GT(on_top(all), 8);
  EXPECT_EQ(on_top(-all), 0);  // the points cover the bottom
}

TEST_F(Export, InteriorIsWhereThePointsAreWhateverTheMeshsFrame) {
  WriteRecording(WithoutInterior(), folder_.File("swing.npz"));
  TriangleMesh mesh = Box();
  const Points upright = mesh.vertices;
  mesh.vertices.row(1) = upright.row(2);
  mesh.vertices.row(2) = -upright.row(1);
  WriteGlb(mesh, folder_.File("y_up.glb"));
  mesh.vertices = 1000 * upright;
  WriteObj(mesh, folder_.File("mm.obj"));
  mesh.vertices = upright.colwise() + Eigen::Vector3d(0.05, 0, 0.03);
  WriteObj(mesh, folder_.File("pivot.obj"));
  const auto fill = [&](const std::string& name) {
    return RunProgram({"interior", folder_.File("swing.npz"), "--mesh", folder_.File(name),
                       "--spacing", "0.005", "-o", folder_.File(name + ".npz")});
  };
  EXPECT_EQ(fill("y_up.glb").errors, "");
  const ProgramResult millimetres = fill("mm.obj");
  EXPECT_EQ(millimetres.errors.rfind("warning: " + folder_.File("mm.obj: taken as millimetres"), 0),
            0u)
      << millimetres.errors;
  for (const char* name : {"y_up.glb.npz", "mm.obj.npz"}) {
    const Points interior = ReadRecording(folder_.File(name)).interior;
    EXPECT_GT(interior.cols(), 1000) << name;
    EXPECT_GT(interior.minCoeff(), -0.004) << name;
    EXPECT_LT((interior.rowwise().maxCoeff() - Eigen::Vector3d(0.084, 0.064, 0.024)).maxCoeff(), 0)
        << name;
  }
  EXPECT_TRUE(FailsWith(fill("pivot.obj"), "is the mesh in another frame or unit?"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("pivot.obj.npz")));
}

}  // namespace
}  // namespace physpring
