// SPDX-License-Identifier: Apache-2.0
// Where nodes touch ground and geoms, with which normal, and the adjoint, one sub-step at a time.
#include "twin/contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/contact_scene.h"

namespace physpring {
namespace {

using Eigen::Vector3d;

// A place around a geom, in the geom's axes, with the outward normal there.
struct Place {
  std::string name;
  Vector3d half_size;
  double radius;
  Vector3d at;      // 0.1 mm off the surface where not inside
  Vector3d normal;  // not yet of length 1
};

const std::vector<Place> kPlaces = {
    {"sphere", {0, 0, 0}, 0.05, 0.0501 * Vector3d(2, -3, 6) / 7, {2, -3, 6}},
    {"sphere, inside", {0, 0, 0}, 0.05, 0.03 * Vector3d(2, -3, 6) / 7, {2, -3, 6}},
    {"capsule, side", {0, 0, 0.1}, 0.05, {0.03006, 0.04008, 0.03}, {3, 4, 0}},
    {"capsule, cap",
     {0, 0, 0.1},
     0.05,
     {0.0501 * 2 / 7, 0.0501 * -3 / 7, -0.1 - 0.0501 * 6 / 7},
     {2, -3, -6}},
    {"box, face", {0.03, 0.04, 0.05}, 0, {0.01, -0.0401, 0.02}, {0, -1, 0}},
    {"box, edge", {0.03, 0.04, 0.05}, 0, {0.03006, -0.01, -0.05008}, {3, 0, -4}},
    {"box, corner",
     {0.03, 0.04, 0.05},
     0,
     {-0.03 - 2e-4 / 7, 0.04 + 3e-4 / 7, 0.05 + 6e-4 / 7},
     {-2, 3, 6}},
    {"box, inside", {0.03, 0.04, 0.05}, 0, {0.01, 0.039, 0.02}, {0, 1, 0}},
    {"rounded box, edge",
     {0.03, 0.04, 0.05},
     0.01,
     {0.03 + 0.0101 * 0.6, 0.02, 0.05 + 0.0101 * 0.8},
     {3, 0, 4}},
};

// A node that comes with `approach` (in the geom's axes, relative to the surface) to a place of a
// geom that is turned, moves and spins.
Scene At(const Place& place, const Vector3d& approach) {
  Geom geom;
  geom.half_size = place.half_size;
  geom.radius = place.radius;
  geom.position = {0.3, -0.2, 0.1};
  geom.rotation = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -2) / 3).toRotationMatrix();
  geom.velocity = {0.5, 0.1, -0.2};
  geom.angular_velocity = {2, -3, 1};
  std::vector<Geom> moved{geom};
  MoveOn(kElapsed, &moved);
  const Vector3d arm = moved[0].rotation * place.at;
  const Vector3d surface_velocity = geom.velocity + geom.angular_velocity.cross(arm);
  Scene scene(moved[0].position + arm, surface_velocity + moved[0].rotation * approach);
  scene.geoms = {geom};
  return scene;
}

Vector3d SomeTangent(const Vector3d& normal) {
  return normal.cross(Vector3d(0.3, 1, 0.2)).normalized();
}

TEST(Contact, ReflectsAtTheNormalOfTheGeom) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    Scene scene = At(place, -2 * n + 0.5 * t);
    scene.system.contact.surface.restitution = 0.25;
    const Scene expected = At(place, 0.5 * n + 0.5 * t);
    EXPECT_NEAR((scene.After() - expected.v).norm(), 0, 1e-12) << place.name;
  }
}

TEST(Contact, StopsTheSlidingRelativeToTheSurface) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    Scene scene = At(place, -2 * n + 0.5 * t);
    scene.system.contact.surface.friction = 1;
    EXPECT_NEAR((scene.After() - At(place, {0, 0, 0}).v).norm(), 0, 1e-12) << place.name;
  }
}

TEST(Contact, LeavesANodeThatDoesNotApproach) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized();
    for (double speed : {1.0, 0.0, -0.5 * kApproach}) {
      const Scene scene = At(place, speed * n + 0.5 * SomeTangent(n));
      EXPECT_EQ(scene.After(), scene.v) << place.name;
    }
  }
}

TEST(ContactAdjoint, MatchesDifferencesAtAGeom) {
  for (const Place& place : kPlaces) {
    const Vector3d n = place.normal.normalized(), t = SomeTangent(n);
    for (double friction : {0.05, 0.9}) {  // slides, sticks
      Scene scene = At(place, -0.7 * n + 0.5 * t);
      scene.system.contact = {{0.4, friction}, {0, 0}, 0};
      for (const GradientReport& report : CheckGradients(scene)) {
        EXPECT_TRUE(report.passed) << place.name << "\n" << report.log;
      }
    }
  }
}

TEST(Contact, BeginsWhereTheSurfaceIsReachedWithinTheSubstep) {
  Scene scene(Vector3d(0, 0, 0), Vector3d(0, 0, -2));
  scene.environment.ground = Eigen::Vector4d(0, 0, 1, 0.05);
  scene.system.contact_radius[0] = 0.01;
  const double gap = 2 * kStep;
  scene.x(2, 0) = 0.05 + 0.01 + 1.001 * gap;
  EXPECT_EQ(scene.After(), scene.v);
  scene.x(2, 0) = 0.05 + 0.01 + 0.999 * gap;
  EXPECT_EQ(scene.After(), Points(Vector3d(0, 0, 0)));
}

TEST(ContactAdjoint, MatchesDifferencesOnASlope) {
  for (double friction : {0.1, 1.5}) {
    Scene scene(Vector3d(0.1, 0.2, -0.3), Vector3d(0.5, 0.3, -1));
    scene.environment.ground = Eigen::Vector4d(2, 3, 6, 0.7) / 7;
    scene.system.contact = {{0.6, friction}, {0, 0}, 0};
    ASSERT_NE(scene.After(), scene.v);
    ExpectGradientsMatch(scene);
  }
}

TEST(ContactAdjoint, MatchesDifferencesBetweenTwoSurfaces) {
  const Place& face = kPlaces[4];
  Scene scene = At(face, {0.3, 1, -0.4});
  scene.system.contact = {{0.4, 0.1}, {0, 0}, 0};
  const Points alone = scene.After();
  const Vector3d x = scene.x.col(0), n = -Vector3d(scene.v.col(0)).normalized();
  scene.environment.ground = Eigen::Vector4d(n[0], n[1], n[2], n.dot(x) - 1e-4);
  ASSERT_NE(scene.After(), alone);
  ExpectGradientsMatch(scene);
}

}  // namespace
}  // namespace physpring
