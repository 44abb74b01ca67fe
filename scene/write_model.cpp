#include <slipmode/core/overloaded.hpp>
#include "scene/internal/scene_words.hpp"
#include "scene/internal/toml_fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace slipmode::scene {

namespace {

std::string chain_toml(const fem::ChainOptions& chain) {
  const auto ends = std::ranges::find_if(kEnds, [&](const Ends& entry) {
    return entry.left_fixed == chain.left_fixed && entry.right_fixed == chain.right_fixed;
  });
  std::string out =
      fmt::format("\n[structure]\nkind = \"chain\"\nmasses = {}\nends = \"{}\"\nmass = {}\nstiffness = {}\n",
                  chain.masses, ends->word, one_or_many_text(chain.mass), one_or_many_text(chain.stiffness));
  if (!chain.ground_stiffness.empty()) {
    out += fmt::format("ground_stiffness = {}\n", one_or_many_text(chain.ground_stiffness));
  }
  return out + number_line("damping", chain.damping) + number_line("mass_damping", chain.mass_damping);
}

std::string span_toml(const fem::BeamSpan& span, fem::BeamTheory theory) {
  std::string out = number_line("length", span.length) + number_line("width", span.width) +
                    number_line("thickness", span.thickness) + number_line("youngs_modulus", span.youngs_modulus) +
                    number_line("density", span.density) + fmt::format("elements = {}\n", span.elements);
  if (theory == fem::BeamTheory::kEulerBernoulli) return out;
  return out + number_line("poisson_ratio", span.poisson_ratio) +
         number_line("shear_coefficient", span.shear_coefficient);
}

std::string damping_toml(const fem::BeamDamping& damping) {
  return std::visit(Overloaded{[](const fem::Rayleigh& rayleigh) {
                                 return number_line("coefficient", rayleigh.stiffness) +
                                        number_line("mass_coefficient", rayleigh.mass);
                               },
                               [](const fem::ProportionalRatios& proportional) {
                                 std::vector<double> ratios, frequencies;
                                 for (const fem::RatioAt& point : proportional.at) {
                                   ratios.push_back(point.ratio);
                                   frequencies.push_back(point.frequency_hz);
                                 }
                                 return fmt::format("ratio = {}\nfrequency = {}\n", one_or_many_text(ratios),
                                                    one_or_many_text(frequencies));
                               },
                               [](const fem::ModalRatios& modal) {
                                 return fmt::format("modal_ratio = {}\n", one_or_many_text(modal.ratios));
                               }},
                    damping);
}

std::string beam_toml(const fem::BeamOptions& beam) {
  std::string out = fmt::format("\n[structure]\nkind = \"beam\"\ntheory = \"{}\"\n",
                                std::ranges::find(kTheories, beam.theory, &TheoryWord::theory)->word);
  if (beam.spans.size() == 1) {
    out += span_toml(beam.spans.front(), beam.theory);
  } else {
    for (const fem::BeamSpan& span : beam.spans) out += "\n[[structure.span]]\n" + span_toml(span, beam.theory);
  }
  out += "\n[structure.tip]\n" + number_line("mass", beam.tip.mass) + number_line("inertia", beam.tip.inertia) +
         number_line("offset", beam.tip.offset) + number_line("extension", beam.tip.extension);
  return out + "\n[structure.damping]\n" + damping_toml(beam.damping);
}

std::string masses_toml(const fem::MassesOptions& masses) {
  std::string out = fmt::format("\n[structure]\nkind = \"masses\"\nmass = {}\n",
                                masses.mass.size() == 1 ? number_text(masses.mass.front()) : numbers_text(masses.mass));
  for (const fem::Link& link : masses.links) {
    const ContactPlace ends =
        link.first == 0 ? ContactPlace{link.second} : ContactPlace{Between{link.first, link.second}};
    out += "\n[[structure.link]]\n" + place_toml(ends) + number_line("stiffness", link.stiffness) +
           number_line("damping", link.damping);
  }
  return out;
}

std::string matrix_text(const Eigen::MatrixXd& matrix) {
  std::vector<std::string> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const Eigen::VectorXd row = matrix.row(i);
    rows.push_back(numbers_text({row.begin(), row.end()}));
  }
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

std::string matrices_toml(const MatricesSpec& spec) {
  return fmt::format("\n[structure]\nkind = \"matrices\"\nmass = {}\ndamping = {}\nstiffness = {}\n",
                     matrix_text(spec.mass), matrix_text(spec.damping), matrix_text(spec.stiffness));
}

std::string load_toml(const friction::NormalLoad& load) {
  if (load.is_constant()) return number_text(load.constant);
  if (!load.oscillator) {
    return fmt::format("{{ constant = {}, slope = {} }}", number_text(load.constant), number_text(load.slope));
  }
  return fmt::format("{{ constant = {}, oscillator = {} }}", number_text(load.constant),
                     inline_table(*load.oscillator));
}

std::string law_toml(const auto& law) { return lines_toml(law); }

/// Stops that are alike are said once.
std::string law_toml(const friction::Clearance& law) {
  const bool alike = law.left && law.right && inline_table(*law.left) == inline_table(*law.right);
  if (!alike) return lines_toml(law);
  return lines_toml(law, {"left", "right"}) + fmt::format("stop = {}\n", inline_table(*law.left));
}

}  // namespace

std::string structure_toml(const Scene& scene) {
  return std::visit(Overloaded{[](const fem::ChainOptions& own) { return chain_toml(own); },
                               [](const fem::BeamOptions& own) { return beam_toml(own); },
                               [](const fem::MassesOptions& own) { return masses_toml(own); },
                               [](const MatricesSpec& own) { return matrices_toml(own); }},
                    scene.structure);
}

std::string contact_toml(const ContactSpec& contact, const Scene& scene) {
  std::string out = fmt::format("\n[[contact]]\nname = {}\n{}law = \"{}\"\n", quoted_text(contact.name),
                                place_toml(contact.at), friction::law_words()[contact.law.index()]);
  const bool clearance = std::holds_alternative<friction::Clearance>(contact.law);
  if (!clearance) out += fmt::format("normal_load = {}\n", load_toml(contact.normal_load));
  out += std::visit([](const auto& law) { return law_toml(law); }, contact.law);
  if (clearance) return out;
  if (contact.tilt_deg != 0.0 || scene.beam() != nullptr) out += number_line("tilt_deg", contact.tilt_deg);
  return out;
}

}  // namespace slipmode::scene
