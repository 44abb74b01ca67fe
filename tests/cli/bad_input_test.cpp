#include <slipmode/results/store.hpp>
#include "cli/slipmode_process.hpp"
#include "cli/small_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace slipmode;
using namespace slipmode::tests;
using testing::HasSubstr;

/// One bad call, and what its message must name: where, which key, which value, what would be right.
struct BadCall {
  std::string name;
  std::vector<std::string> arguments;
  std::vector<std::string> said;
};

void PrintTo(const BadCall& call, std::ostream* out) { *out << call.name; }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

class BadInput : public testing::TestWithParam<BadCall> {
 protected:
  /// Everything the calls refer to; made once, as it takes a simulation.
  static void SetUpTestSuite() {
    inputs_ = std::make_unique<TemporaryFolder>();
    const auto& at = inputs_->path();
    write_file(at / "good.toml", kTwoContacts);
    write_file(at / "syntax.toml", "title = \"x\nunits = 3\n");
    write_file(at / "unknown.toml", replaced(kTwoContacts, "damping =", "dampnig ="));
    write_file(at / "missing.toml", replaced(kTwoContacts, "normal_load = 5.0", ""));
    write_file(at / "type.toml", replaced(kTwoContacts, "masses = 4", "masses = \"four\""));
    write_file(at / "friction.toml", replaced(kTwoContacts, "mu_s = 0.4", "mu_s = 0.2"));
    write_file(at / "mass.toml", replaced(kTwoContacts, "mass = 2.0", "mass = -2.0"));
    write_file(at / "none.toml", replaced(kTwoContacts, "masses = 4", "masses = 0"));
    write_file(at / "off.toml", replaced(kTwoContacts, "at = 4", "at = 5"));
    // Three snapshots have a rank of two about their mean.
    slipmode_in(*inputs_, {"simulate", "good.toml", "-o", "few.h5", "--set", "time.duration=10.1"});
    slipmode_in(*inputs_, {"simulate", "good.toml", "-o", "run.h5"});
    slipmode_in(*inputs_, {"pod", "run.h5", "-o", "pod.h5"});
    slipmode_in(*inputs_, {"modes", "good.toml", "-o", "modes.h5"});
    write_file(at / "truncated.h5", bytes_of(at / "pod.h5").substr(0, 2000));
    Eigen::MatrixXd vectors = Eigen::MatrixXd::Identity(4, 2);
    vectors(1, 1) = std::numeric_limits<double>::quiet_NaN();
    results::StoreWriter writer(at / "nan.h5", results::FileKind::kBasis);
    writer.write("basis/vectors", vectors, {"1", "made by hand"});
    writer.commit();
  }
  static void TearDownTestSuite() { inputs_.reset(); }

  static std::unique_ptr<TemporaryFolder> inputs_;
};
std::unique_ptr<TemporaryFolder> BadInput::inputs_;

TEST_P(BadInput, IsRefusedWithPlaceAndRemedyAndLeavesNoFile) {
  const BadCall& call = GetParam();
  const std::vector<std::string> before = inputs_->names();
  const Outcome outcome = slipmode_in(*inputs_, call.arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& part : call.said) EXPECT_THAT(outcome.err, HasSubstr(part));
  EXPECT_EQ(inputs_->names(), before);

  std::vector<std::string> with_json = call.arguments;
  with_json.emplace_back("--json");
  const auto object = slipmode_in(*inputs_, with_json).json();
  EXPECT_EQ(object["status"], "failed");
  EXPECT_EQ(object["exit_code"], 2);
  for (const std::string& part : call.said) EXPECT_THAT(object["message"].get<std::string>(), HasSubstr(part));
  EXPECT_EQ(inputs_->names(), before);
}

const BadCall kCalls[] = {
    {"MissingScene", {"run", "nowhere.toml", "-o", "o"}, {"nowhere.toml", "no such", "check the path"}},
    {"BadToml", {"run", "syntax.toml", "-o", "a/b/o"}, {"syntax.toml:1", "not valid TOML"}},
    {"UnknownKey", {"simulate", "unknown.toml", "-o", "o.h5"}, {"unknown.toml:9", "dampnig", "0.002", "'damping'"}},
    {"MissingKey", {"simulate", "missing.toml", "-o", "o.h5"}, {"missing.toml:17", "contact.1.normal_load", "add it"}},
    {"WrongType", {"run", "type.toml", "-o", "o"}, {"type.toml:6", "structure.masses", "four", "integer"}},
    {"StaticBelowKinetic",
     {"run", "friction.toml", "-o", "o"},
     {"friction.toml:20", "contact.1.mu_s", "0.2", "mu_k = 0.3", "valid: mu_s >= 0.3"}},
    {"NegativeMass", {"modes", "mass.toml"}, {"mass.toml:7", "structure.mass", "-2", "> 0"}},
    {"NoMasses", {"modes", "none.toml"}, {"none.toml:6", "structure.masses", "0", "from 1"}},
    {"ContactOffTheChain", {"modes", "off.toml"}, {"off.toml:18", "contact.1.at", "5", "from 1 to 4"}},
    {"NanInABasis",
     {"reduce", "good.toml", "nan.h5", "--modes", "2", "-o", "o.h5"},
     {"nan.h5", "basis/vectors", "nan"}},
    {"TruncatedFile", {"reduce", "good.toml", "truncated.h5", "-o", "o.h5"}, {"truncated.h5", "truncated", "again"}},
    {"NotAResult", {"info", "good.toml"}, {"good.toml", "not an HDF5 file", "slipmode"}},
    {"ModesOfAnEnsembleNotAskedFor",
     {"pod", "good.toml", "-o", "o.h5"},
     {"good.toml", "has no [ensemble]", "slipmode simulate"}},
    {"FolderNotWritable", {"run", "good.toml", "-o", "/proc/slipmode/o"}, {"/proc/slipmode/o", "choose another"}},
    {"NoFolderForTheOutput", {"simulate", "good.toml", "-o", "no/o.h5"}, {"no/o.h5", "create it"}},
    {"OutputIsAFile", {"run", "good.toml", "-o", "good.toml"}, {"good.toml", "give a folder"}},
    {"MoreModesThanRank", {"pod", "few.h5", "--modes", "3", "-o", "o.h5"}, {"few.h5", "--modes 3", "rank"}},
    {"MoreModesThanTheBasis",
     {"reduce", "good.toml", "pod.h5", "--modes", "5", "-o", "o.h5"},
     {"modes = 5", "pod.h5", "1 to 4"}},
    {"BasisOfAnotherScene",
     {"reduce", "good.toml", "pod.h5", "--modes", "2", "-o", "o.h5", "--set", "structure.masses=6"},
     {"pod.h5", "expected 6"}},
    {"OverrideOfNothing", {"modes", "good.toml", "--set", "drive.spede=1.0"}, {"drive.spede=1.0", "'speed'"}},
    {"OverrideWithoutValue", {"modes", "good.toml", "--set", "drive.speed"}, {"drive.speed", "PATH=VALUE"}},
    {"OverrideNotFinite", {"modes", "good.toml", "--set", "drive.speed=nan"}, {"drive.speed", "nan", "finite"}},
    {"RangeOfTwo",
     {"sweep", "good.toml", "--over", "drive.speed=0.5:0.4", "-o", "o.h5"},
     {"drive.speed=0.5:0.4", "FROM:TO:STEP"}},
    {"RangeThatDoesNotEnd", {"sweep", "good.toml", "--over", "drive.speed=0.5:0.4:0.0", "-o", "o.h5"}, {"step"}},
    {"RangeIntoTheImpossible",
     {"sweep", "good.toml", "--over", "structure.damping=0.1:-0.1:0.1", "-o", "o.h5"},
     {"structure.damping", "-0.1", ">= 0"}},
    {"SweepOverTheSize",
     {"sweep", "good.toml", "--over", "structure.masses=4:6:1", "-o", "o.h5"},
     {"structure.masses", "must stay at 4"}},
    {"ModelThatIsNone",
     {"sweep", "good.toml", "--over", "drive.speed=0.5:0.4:0.1", "--model", "rom:pod.h5", "-o", "o.h5"},
     {"pod.h5", "holds a POD; expected a reduced model", "slipmode reduce"}},
    {"FigureOfNoFormat", {"plot", "pod.h5", "-o", "o.jpg"}, {"o.jpg", ".svg, .png or .pdf"}},
    {"PodOfAPod",
     {"pod", "pod.h5", "-o", "o.h5"},
     {"'pod.h5' holds a POD; expected an ensemble, a trajectory or an orbit", "slipmode simulate"}},
    {"ReducedByATrajectory",
     {"reduce", "good.toml", "run.h5", "-o", "o.h5"},
     {"'run.h5' holds a trajectory; expected a POD, a reduced model or a basis", "slipmode pod"}},
    {"ValidatedByModes",
     {"validate", "good.toml", "modes.h5", "-o", "o.h5"},
     {"'modes.h5' holds natural modes; expected a POD, an ensemble, a reduced model", "slipmode pod"}},
    {"NothingOfItIsDrawn",
     {"plot", "nan.h5", "-o", "o.png"},
     {"'nan.h5' holds a basis; expected a trajectory, a POD", "slipmode simulate --single"}},
    {"AKeyOfNoScene", {"info", "pod.h5", "--set", "drive.speed=0.1"}, {"--set", "not expected"}},
    {"AKeyOfAResult",
     {"pod", "run.h5", "-o", "o.h5", "--set", "drive.speed=0.1"},
     {"--set has no use", "give the scene"}},
    {"AKeyOfARecord", {"diagnose", "run.h5", "--set", "drive.speed=0.1"}, {"--set has no use", "give a scene"}},
    {"FigureOfAnotherFile", {"plot", "pod.h5", "--figure", "orbits", "-o", "o.png"}, {"orbits", "shapes, energy"}},
    {"NoVerb", {}, {"--help"}},
    {"UnknownVerb", {"simulat", "good.toml"}, {"simulat: no such verb", "run, modes, simulate"}},
    {"NoOutput", {"run", "good.toml"}, {"output", "--help"}},
    {"NegativeThreads", {"modes", "good.toml", "--threads", "-1"}, {"--threads", "-1"}},
};

INSTANTIATE_TEST_SUITE_P(Calls, BadInput, testing::ValuesIn(kCalls), [](const auto& call) { return call.param.name; });

}  // namespace
