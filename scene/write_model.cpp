#include <slipmode/core/overloaded.hpp>
#include "scene/internal/scene_parts.hpp"
#include "scene/internal/scene_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::scene {

namespace {

std::string chain_toml(const fem::ChainOptions& chain) {
  return fmt::format("\n[structure]\nkind = \"chain\"\nmasses = {}\nends = \"{}-{}\"\n", chain.masses,
                     chain.left_fixed ? "fixed" : "free", chain.right_fixed ? "fixed" : "free") +
         lines_toml(chain, {"masses"});
}

std::string damping_toml(const fem::BeamDamping& damping) {
  return std::visit(Overloaded{[](const fem::Rayleigh& rayleigh) { return lines_toml(rayleigh); },
                               [](const fem::ProportionalRatios& proportional) {
                                 std::vector<double> ratios, frequencies;
                                 for (const fem::RatioAt& point : proportional.at) {
                                   ratios.push_back(point.ratio);
                                   frequencies.push_back(point.frequency_hz);
                                 }
                                 return fmt::format("ratio = {}\nfrequency = {}\n", one_or_many_text(ratios),
                                                    one_or_many_text(frequencies));
                               },
                               [](const fem::ModalRatios& modal) { return lines_toml(modal); }},
                    damping);
}

std::string beam_toml(const fem::BeamOptions& beam) {
  const Without shear = without_shear(beam.theory);
  std::string out = "\n[structure]\nkind = \"beam\"\n" + lines_toml(beam);
  if (beam.spans.size() == 1) {
    out += lines_toml(beam.spans.front(), shear);
  } else {
    for (const fem::BeamSpan& span : beam.spans) out += "\n[[structure.span]]\n" + lines_toml(span, shear);
  }
  return out + "\n[structure.tip]\n" + lines_toml(beam.tip) + "\n[structure.damping]\n" + damping_toml(beam.damping);
}

std::string masses_toml(const fem::MassesOptions& masses) {
  std::string out = "\n[structure]\nkind = \"masses\"\n" + lines_toml(masses);
  for (const fem::Link& link : masses.links) {
    const ContactPlace ends =
        link.first == 0 ? ContactPlace{link.second} : ContactPlace{Between{link.first, link.second}};
    out += "\n[[structure.link]]\n" + place_toml(ends) + lines_toml(link);
  }
  return out;
}

std::string matrix_text(const Eigen::MatrixXd& matrix) {
  std::vector<std::string> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd row = matrix.row(i);
    rows.push_back(value_toml(row));
  }
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

std::string matrices_toml(const MatricesSpec& spec) {
  return fmt::format("\n[structure]\nkind = \"matrices\"\nmass = {}\ndamping = {}\nstiffness = {}\n",
                     matrix_text(spec.mass), matrix_text(spec.damping), matrix_text(spec.stiffness));
}

std::string head_toml(const std::string& name, const ContactPlace& at, const std::string& law) {
  return fmt::format("\n[[contact]]\nname = {}\n{}law = \"{}\"\n", quoted_text(name), place_toml(at), law);
}

/// How many contacts from c on are a joint as the scene said it, none of them changed; 0 where c begins none.
std::size_t elements_from(const std::vector<ContactSpec>& contacts, std::size_t c) {
  if (!contacts[c].joint) return 0;
  const std::vector<friction::JenkinsElement> elements = friction::elements_of(contacts[c].joint->law);
  for (std::size_t k = 0; k < elements.size(); ++k) {
    if (c + k >= contacts.size()) return 0;
    const ContactSpec& own = contacts[c + k];
    const auto* law = std::get_if<friction::CompliantCoulomb>(&own.law);
    const bool same = own.joint && own.joint->element == k && own.joint->name == contacts[c].joint->name &&
                      law != nullptr && law->stiffness == elements[k].stiffness && own.normal_load.is_constant() &&
                      own.normal_load.constant == elements[k].slip_force;
    if (!same) return 0;
  }
  return elements.size();
}

std::string load_toml(const friction::NormalLoad& load) {
  if (load.is_constant()) return number_text(load.constant);
  return inline_table(load, load.oscillator ? Without{"slope"} : Without{});
}

std::string law_toml(const auto& law) { return lines_toml(law); }

/// Stops that are alike are said once.
std::string law_toml(const friction::Clearance& law) {
  const bool alike = law.left && law.right && inline_table(*law.left) == inline_table(*law.right);
  if (!alike) return lines_toml(law);
  return lines_toml(law, {"left", "right"}) + fmt::format("stop = {}\n", inline_table(*law.left));
}

std::string contact_toml(const ContactSpec& contact, const Scene& scene) {
  std::string out = head_toml(contact.name, contact.at, friction::law_word(contact.law));
  const bool clearance = friction::clearance(contact.law) != nullptr;
  if (!clearance) out += fmt::format("normal_load = {}\n", load_toml(contact.normal_load));
  out += std::visit([](const auto& law) { return law_toml(law); }, contact.law);
  if (clearance) return out;
  if (contact.tilt_deg != 0.0 || scene.beam() != nullptr) out += number_line("tilt_deg", contact.tilt_deg);
  return out;
}

}  // namespace

std::string structure_toml(const Scene& scene) {
  return std::visit(Overloaded{[](const fem::ChainOptions& own) { return chain_toml(own); },
                               [](const fem::BeamOptions& own) { return beam_toml(own); },
                               [](const fem::MassesOptions& own) { return masses_toml(own); },
                               [](const MatricesSpec& own) { return matrices_toml(own); }},
                    scene.structure);
}

std::string contacts_toml(const Scene& scene) {
  std::string out;
  for (std::size_t c = 0; c < scene.contacts.size();) {
    const ContactSpec& own = scene.contacts[c];
    const std::size_t elements = elements_from(scene.contacts, c);
    out += elements == 0 ? contact_toml(own, scene)
                         : head_toml(own.joint->name, own.at, friction::Iwan::word) + lines_toml(own.joint->law);
    c += std::max<std::size_t>(elements, 1);
  }
  return out;
}

}  // namespace slipmode::scene
