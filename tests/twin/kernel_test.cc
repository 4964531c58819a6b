// SPDX-License-Identifier: Apache-2.0
// Every kernel that this processor can run gives the bits of the scalar reference.
#include "twin/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/random_system.h"
#include "twin/error.h"
#include "twin/kernel_choice.h"
#include "twin/spring_blocks.h"

namespace physpring {
namespace {

// `springs` random springs between random nodes, a pair at most once; some have no length.
SpringMassSystem Network(int nodes, int springs, Random* random) {
  SpringMassSystem system;
  system.position = random->Box(nodes, 0.1);
  system.position.col(nodes - 1) = system.position.col(0);
  std::vector<std::array<int, 2>> pairs;
  for (int a = 0; a < nodes; ++a) {
    for (int b = a + 1; b < nodes; ++b) pairs.push_back({a, b});
  }
  for (int e = 0; e < springs; ++e) {
    const auto rest = static_cast<double>(pairs.size() - static_cast<std::size_t>(e));
    std::swap(pairs[e], pairs[e + static_cast<int>((*random)(0, rest))]);
    system.springs.push_back(pairs[e]);
  }
  system.mass.setConstant(nodes, 1);
  const auto fill = [&](double low, double high) {
    Eigen::VectorXd values(springs);
    for (double& value : values) value = (*random)(low, high);
    return values;
  };
  system.stiffness = fill(10, 100);
  system.rest_length = fill(0.01, 0.1);
  system.dashpot = fill(0, 0.1);
  return system;
}

// All that a sub-step and its adjoint read and write.
template <class Real>
struct Data {
  SpringBlocks<Real> springs;
  NodeStates<Real> state, next, state_bar;
  NodeForces<Real> force, force_bar;
  SpringBlockGradient<Real> spring_bar;
  // of each spring, random; the last three are what a kernel measures
  std::vector<Real> tension, length_bar, rate_bar, length, rate, tension_bar;
  std::vector<Real> h_over_mass;
  NodeForces<Real> node_bar;  // mass, drag, gravity

  Data(const SpringMassSystem& system, Random* random)
      : springs(system),
        state(springs.spare_node + 1),
        next(state),
        state_bar(state),
        force(springs.spare_node + 1),
        force_bar(force),
        spring_bar(springs.size()),
        tension(springs.size()),
        h_over_mass(springs.spare_node),
        node_bar(springs.spare_node + 2) {
    const auto fill = [&](Real* values) {
      for (int j = 0; j < 3; ++j) values[j] = static_cast<Real>((*random)(-1, 1));
    };
    for (int i = 0; i < springs.spare_node; ++i) {
      for (int j = 0; j < 3; ++j) state[i].x[j] = static_cast<Real>(system.position(j, i));
      for (NodeState<Real>* node : {&state[i], &next[i], &state_bar[i]}) fill(node->v);
      fill(state_bar[i].x);
      fill(force[i].f);
      fill(force_bar[i].f);
      h_over_mass[i] = static_cast<Real>((*random)(1e-4, 1e-3));
    }
    length_bar = rate_bar = length = rate = tension_bar = tension;
    for (std::vector<Real>* values : {&tension, &length_bar, &rate_bar}) {
      for (Real& value : *values) value = static_cast<Real>((*random)(-1, 1));
    }
  }

  NodeView<Real> Nodes() const {
    return {springs.spare_node, h_over_mass.data(), Real(1e-3), Real(0.999), {{0, 0, -0.01, 0}}};
  }
  SpringView<Real> TenseSprings() const {
    SpringView<Real> view = springs.View();
    view.tension = tension.data();
    return view;
  }
  SpringGradientView<Real> TenseSpringBar() {
    SpringGradientView<Real> view = spring_bar.View();
    view.length = length_bar.data();
    view.rate = rate_bar.data();
    return view;
  }
  SpringMeasures<Real> Measures() { return {length.data(), rate.data(), tension_bar.data()}; }
  NodeGradientView<Real> NodeBar() {
    NodeForce<Real>* end = &node_bar[springs.spare_node];
    return {node_bar.data(), end, end + 1};
  }
};

template <class T>
bool SameBits(const std::vector<T>& p, const std::vector<T>& q) {
  return p.size() == q.size() && std::memcmp(p.data(), q.data(), p.size() * sizeof(T)) == 0;
}

template <class Real>
void ExpectSameBits(const Data<Real>& data, const Data<Real>& reference) {
  EXPECT_TRUE(SameBits(data.next, reference.next));
  EXPECT_TRUE(SameBits(data.state_bar, reference.state_bar));
  EXPECT_TRUE(SameBits(data.force, reference.force));
  EXPECT_TRUE(SameBits(data.force_bar, reference.force_bar));
  EXPECT_TRUE(SameBits(data.spring_bar.stiffness, reference.spring_bar.stiffness));
  EXPECT_TRUE(SameBits(data.spring_bar.rest_length, reference.spring_bar.rest_length));
  EXPECT_TRUE(SameBits(data.spring_bar.dashpot, reference.spring_bar.dashpot));
  EXPECT_TRUE(SameBits(data.length, reference.length));
  EXPECT_TRUE(SameBits(data.rate, reference.rate));
  EXPECT_TRUE(SameBits(data.tension_bar, reference.tension_bar));
  EXPECT_TRUE(SameBits(data.node_bar, reference.node_bar));
}

// Runs `function` of every kernel on the same data.
template <class Real, class Function>
void CompareKernels(const SpringMassSystem& system, Function function) {
  Random random(7);
  const Data<Real> data(system, &random);
  Data<Real> reference = data;
  function(*FindKernel<Real>("scalar"), &reference);
  for (std::string_view name : kKernelNames) {
    SCOPED_TRACE(std::string(name) + (sizeof(Real) == 4 ? " float" : " double"));
    const Kernel<Real>* kernel = FindKernel<Real>(name);
    if (kernel == nullptr) continue;  // not on this processor
    Data<Real> result = data;
    function(*kernel, &result);
    ExpectSameBits(result, reference);
  }
}

// In float and double, on networks of every number of springs around the sizes of a block and of a
// vector, in which blocks are full or not and neighbouring blocks share nodes.
template <class Function>
void CompareKernels(Function function) {
  Random random(3);
  for (int springs = 1; springs <= 70; ++springs) {
    for (int nodes : {13, 25}) {
      SCOPED_TRACE(std::to_string(nodes) + " nodes, " + std::to_string(springs) + " springs");
      const SpringMassSystem system = Network(nodes, springs, &random);
      CompareKernels<float>(system, function);
      CompareKernels<double>(system, function);
    }
  }
  const SpringMassSystem system = Network(300, 4000, &random);
  CompareKernels<float>(system, function);
  CompareKernels<double>(system, function);
}

TEST(Kernel, SpringForcesAreThoseOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    kernel.add_spring_forces(data->springs.View(), data->state.data(), data->force.data());
  });
}

TEST(Kernel, SpringForcesAdjointIsThatOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    for (int repeat = 0; repeat < 2; ++repeat) {  // adds up
      kernel.add_spring_forces_adjoint(data->springs.View(), data->state.data(),
                                       data->force_bar.data(), data->state_bar.data(),
                                       data->spring_bar.View());
    }
  });
}

TEST(Kernel, MeasuresAreThoseOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    kernel.measure_springs(data->springs.View(), data->state.data(), nullptr, data->Measures());
  });
  CompareKernels([](const auto& kernel, auto* data) {
    kernel.measure_springs(data->springs.View(), data->state.data(), data->force_bar.data(),
                           data->Measures());
  });
}

TEST(Kernel, ForcesWithTensionAreThoseOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    kernel.add_spring_forces(data->TenseSprings(), data->state.data(), data->force.data());
  });
}

TEST(Kernel, ForcesAdjointWithTensionIsThatOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    kernel.add_spring_forces_adjoint(data->TenseSprings(), data->state.data(),
                                     data->force_bar.data(), data->state_bar.data(),
                                     data->TenseSpringBar());
  });
}

// Without effects the bits are those of springs alone.
TEST(Kernel, TensionOfZeroChangesNoBit) {
  CompareKernels([](const auto& kernel, auto* data) {
    auto plain = *data;
    kernel.add_spring_forces(plain.springs.View(), plain.state.data(), plain.force.data());
    kernel.add_spring_forces_adjoint(plain.springs.View(), plain.state.data(),
                                     plain.force_bar.data(), plain.state_bar.data(),
                                     plain.spring_bar.View());
    for (auto* values : {&data->tension, &data->length_bar, &data->rate_bar}) {
      std::fill(values->begin(), values->end(), 0);
    }
    kernel.add_spring_forces(data->TenseSprings(), data->state.data(), data->force.data());
    kernel.add_spring_forces_adjoint(data->TenseSprings(), data->state.data(),
                                     data->force_bar.data(), data->state_bar.data(),
                                     data->TenseSpringBar());
    ExpectSameBits(*data, plain);
  });
}

TEST(Kernel, NodeUpdateIsThatOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    const auto nodes = data->Nodes();
    kernel.update_velocities(nodes, data->state.data(), data->force.data(), data->next.data());
    kernel.update_positions(nodes, data->state.data(), data->next.data());
  });
}

TEST(Kernel, NodeUpdateAdjointIsThatOfTheReference) {
  CompareKernels([](const auto& kernel, auto* data) {
    const auto nodes = data->Nodes();
    for (int repeat = 0; repeat < 2; ++repeat) {
      kernel.update_positions_adjoint(nodes, data->state_bar.data());
      kernel.update_velocities_adjoint(nodes, data->state.data(), data->next.data(),
                                       data->state_bar.data(), data->force_bar.data(),
                                       data->NodeBar());
    }
  });
}

TEST(KernelChoice, TakesTheOneWishedForOrTheFastest) {
  EXPECT_EQ(&ChooseKernel<float>("scalar"), FindKernel<float>("scalar"));
  const char* fastest = "scalar";
  for (const char* name : {"avx2", "avx512"}) {
    if (FindKernel<double>(name) != nullptr) fastest = name;
  }
  EXPECT_STREQ(ChooseKernel<float>("").name, fastest);
  EXPECT_STREQ(ChooseKernel<double>("").name, fastest);
}

TEST(KernelChoice, RefusesOneThatCannotRun) {
  EXPECT_EQ(FindKernel<float>("sse9"), nullptr);
  try {
    ChooseKernel<float>("sse9");
    FAIL();
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find("PHYSPRING_KERNEL='sse9': is no kernel for this processor; these are: "
                        "scalar"),
              0u)
        << what;
  }
}

}  // namespace
}  // namespace physpring
