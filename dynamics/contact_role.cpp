#include <slipmode/dynamics/contact_role.hpp>

namespace slipmode::dynamics {

ContactAnswer contact_answer(const friction::ContactForces& law, const friction::LoadForm& load, ContactRole role) {
  ContactAnswer answer{.load = load};
  const auto press = [&](const friction::Stop& stop) {
    answer.stiffness = stop.stiffness;
    answer.damping = stop.damping;
  };
  if (role == ContactRole::kSprung) answer.stiffness = law.stiffness;
  if (role == ContactRole::kLeftStop) press(*law.clearance.left);
  if (role == ContactRole::kRightStop) press(*law.clearance.right);
  if (role == ContactRole::kSlidingNegative) answer.friction = -law.kinetic_coefficient(-1.0);
  if (role == ContactRole::kSlidingPositive) answer.friction = law.kinetic_coefficient(1.0);
  if (answer.friction != 0.0) {
    answer.stiffness -= answer.friction * load.y;
    answer.damping -= answer.friction * load.v;
  }
  return answer;
}

std::vector<StopGuard> stop_guards(const friction::Clearance& law, ContactMode mode) {
  std::vector<StopGuard> guards;
  if (mode == ContactMode::kGap) {
    if (law.right) guards.push_back({.sign = -1.0, .constant = law.right->gap, .next = ContactMode::kRightStop});
    if (law.left) guards.push_back({.sign = 1.0, .constant = law.left->gap, .next = ContactMode::kLeftStop});
    return guards;
  }
  const double side = side_of(mode);
  const friction::Stop& stop = side < 0.0 ? *law.left : *law.right;
  const bool flies = mode == ContactMode::kLeftFlight || mode == ContactMode::kRightFlight;
  const bool by_gap = law.loss == friction::ContactLoss::kGap;
  if (by_gap || flies) guards.push_back({.sign = side, .constant = -stop.gap, .next = ContactMode::kGap});
  if (by_gap) return guards;
  // Without damping the force vanishes where the gap begins: there is no flight beyond it.
  const ContactMode pressed = side < 0.0 ? ContactMode::kLeftStop : ContactMode::kRightStop,
                    flight = side < 0.0 ? ContactMode::kLeftFlight : ContactMode::kRightFlight;
  guards.push_back({.press = true,
                    .sign = flies ? -1.0 : 1.0,
                    .next = flies                ? pressed
                            : stop.damping > 0.0 ? flight
                                                 : ContactMode::kGap});
  return guards;
}

}  // namespace slipmode::dynamics
