// SPDX-License-Identifier: Apache-2.0
// The arrays of a twin with effects, as array_bytes.h writes them.
#include "twin/twin.h"

#include "report/info_text.h"
#include "tests/fuzz/array_bytes.h"
#include "tests/fuzz/fuzz_target.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

// Three particles in a row and a controller.
TwinLevel Row() {
  TwinLevel level;
  SpringMassSystem& system = level.system;
  system.position.resize(3, 4);
  system.position << 0, 0.1, 0.2, 0.3, 0, 0, 0.01, 0, 0, 0, 0, 0.02;
  system.controllers = 1;
  system.springs = {{0, 1}, {1, 2}, {2, 3}};
  system.mass = Eigen::VectorXd::Constant(3, 0.01);
  system.stiffness = Eigen::VectorXd::Constant(3, 100);
  system.rest_length = Eigen::VectorXd::Constant(3, 0.1);
  system.dashpot = Eigen::VectorXd::Constant(3, 0.1);
  system.contact_radius = Eigen::VectorXd::Constant(3, 0.005);
  level.substeps_per_second = 1000;
  system.dashpot_stages = 3;
  return level;
}

Npz StoredTwin(const Twin& twin) {
  const std::string path = FuzzFolder() + "/seed.twin.npz";
  WriteTwin(twin, path);
  return ReadNpz(path);
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const Npz arrays = ArraysOf(TextOf(data, size));
  MayRefuse("file: ", [&] {
    const Twin twin = ParseTwin(arrays, "file");  // what is read can be described
    DescribeTwin(twin);
    TwinToJson(twin).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (!twin.posterior.empty()) SampleOf(twin, 1, 0);
  });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  Twin twin;
  twin.name = "row";
  twin.points = 3;
  twin.fps = 30;
  twin.levels = {Row()};
  const Npz plain = StoredTwin(twin);
  twin.rod = PlainRod(Eigen::VectorXd::LinSpaced(4, 0, 0.3));
  twin.levels[0].system.effects = {{"tension_only", Eigen::VectorXd::Constant(1, 0.3)},
                                   {"air_drag", Eigen::VectorXd::Constant(4, 0.1)}};
  const Npz with_effects = StoredTwin(twin);
  twin.rod = RodOfEdges({{0, 1}, {1, 2}, {1, 3}}, twin.levels[0].system.position);
  twin.posterior = {Eigen::MatrixXd::Constant(2, 3, 0.1), Eigen::MatrixXd::Constant(2, 3, 0.2),
                    Eigen::VectorXd::Constant(2, 0.3), Eigen::MatrixXd::Constant(2, 2, 0.1),
                    Eigen::MatrixXd::Constant(2, 5, 0.1)};
  twin.ground = {.known = true, .plane = Eigen::Vector4d(0, 0, 1, -1)};
  twin.trained_on = {{"swing", "0123456789abcdef", 20}};
  twin.options_json = R"({"epochs":3,"a":[[1]]})";
  const double state = 0.5;
  twin.training_state["train/x"] = NpzArray::Doubles({1}, &state);
  return {BytesOf(plain), BytesOf(with_effects), BytesOf(StoredTwin(twin))};
}
