// SPDX-License-Identifier: Apache-2.0
#include "rollout/effects/scene_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "rollout/scene.h"

namespace physpring {

SceneBody::SceneBody(const mjModel& plain, const SoftPoints& soft)
    : plain_(plain), soft_(soft), particles_(soft.Particles()) {
  for (const int element : particles_) carriers_.insert(BodyOf(plain, soft, element));
  const DataPtr data = MakeData(plain);
  mj_kinematics(&plain, data.get());
  mj_comPos(&plain, data.get());
  mj_flex(&plain, data.get());
  reference_ = PositionsOf(*data, soft, particles_);
  held_ = PositionsOf(*data, soft, soft.controllers);
  vertices_ = Eigen::Map<const Points>(data->flexvert_xpos, 3, plain.nflexvert);
  sites_ = Eigen::Map<const Points>(data->site_xpos, 3, plain.nsite);
}

int SceneBody::CarrierOf(int particle) const {
  return BodyOf(plain_, soft_, particles_[static_cast<std::size_t>(particle)]);
}

std::vector<int> SceneBody::Grounds() const {
  std::vector<int> grounds;
  const std::vector<int> geoms = GeomsInTheWay(plain_, soft_);
  std::copy_if(geoms.begin(), geoms.end(), std::back_inserter(grounds),
               [&](int geom) { return IsGround(plain_, geom); });
  return grounds;
}

int SceneBody::FreeEnd() const {
  Eigen::VectorXd away(reference_.cols());
  for (Eigen::Index i = 0; i < away.size(); ++i) {
    away[i] = (held_.colwise() - reference_.col(i)).colwise().squaredNorm().minCoeff();
  }
  Eigen::Index end = 0;
  away.maxCoeff(&end);
  return static_cast<int>(end);
}

int SceneBody::NearestTo(const Eigen::Vector3d& place) const {
  Eigen::Index nearest = 0;
  (reference_.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

void SceneBody::ForEachTendon(mjSpec* spec,
                              const std::function<void(mjsTendon*, int)>& edit) const {
  if (soft_.of_flex) return;
  int e = 0;
  for (mjsElement* element = mjs_firstElement(spec, mjOBJ_TENDON); element && e < plain_.ntendon;
       element = mjs_nextElement(spec, element), ++e) {
    const int first = plain_.tendon_adr[e], last = first + plain_.tendon_num[e] - 1;
    if (plain_.wrap_type[first] != mjWRAP_SITE || plain_.wrap_type[last] != mjWRAP_SITE) continue;
    edit(mjs_asTendon(element), e);
  }
}

Eigen::Vector3d SceneBody::MiddleOf(int tendon) const {
  const int first = plain_.tendon_adr[tendon], last = first + plain_.tendon_num[tendon] - 1;
  return (sites_.col(plain_.wrap_objid[first]) + sites_.col(plain_.wrap_objid[last])) / 2;
}

void SceneBody::ForEachEdgeTendon(mjSpec* spec, const std::function<void(mjsTendon*)>& edit) const {
  if (!soft_.of_flex) return;
  for (int e = 0; e < plain_.flex_edgenum[0]; ++e) {
    if (plain_.flexedge_rigid[e]) continue;
    const std::string name = fmt::format("edge {}", e);
    mjsElement* known = mjs_findElement(spec, mjOBJ_TENDON, (kAddedPrefix + name).c_str());
    if (known) {
      edit(mjs_asTendon(known));
      continue;
    }
    const int p = plain_.flex_edge[2 * e], q = plain_.flex_edge[2 * e + 1];
    const std::string from = SiteOfElement(p, spec), to = SiteOfElement(q, spec);
    mjsTendon* tendon = AddTendon(spec, name, from, to);
    tendon->springlength[0] = tendon->springlength[1] =
        (vertices_.col(p) - vertices_.col(q)).norm();
    edit(tendon);
  }
}

std::string SceneBody::SiteOn(int particle, mjSpec* spec) const {
  return SiteOfElement(particles_[static_cast<std::size_t>(particle)], spec);
}

std::string SceneBody::SiteOfElement(int element, mjSpec* spec) const {
  if (!soft_.of_flex) return mj_id2name(&plain_, mjOBJ_SITE, element);
  const std::string name = fmt::format("{}{}", kAddedPrefix, element);
  if (mjs_findElement(spec, mjOBJ_SITE, name.c_str())) return name;
  const char* body = mj_id2name(&plain_, mjOBJ_BODY, BodyOf(plain_, soft_, element));
  mjsSite* site = mjs_addSite(mjs_findBody(spec, body), nullptr);
  mjs_setName(site->element, name.c_str());
  for (int i = 0; i < 3; ++i) site->pos[i] = plain_.flex_vert[3 * element + i];
  return name;
}

mjsTendon* AddTendon(mjSpec* spec, const std::string& name, const std::string& from,
                     const std::string& to) {
  mjsTendon* tendon = mjs_addTendon(spec, nullptr);
  mjs_setName(tendon->element, (kAddedPrefix + name).c_str());
  mjs_wrapSite(tendon, from.c_str());
  mjs_wrapSite(tendon, to.c_str());
  return tendon;
}

}  // namespace physpring
