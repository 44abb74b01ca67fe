#include <slipmode/core/exchange.hpp>

#include <slipmode/core/errors.hpp>
#include "network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

namespace slipmode {
namespace {

using testing::HasSubstr;
using tests::Network;

TEST(Exchange, TakesParcelsBySenderInTheOrderTheyWereSent) {
  Network network(3);
  const Ranks zero = network.rank(0), one = network.rank(1), two = network.rank(2);
  const Exchange from_one(one, nullptr), from_two(two, nullptr);
  from_two.send(0, "a");
  from_one.send(0, std::vector<double>{0.1, -1e-310});
  from_one.send(0, "");
  from_two.send(0, "b");
  Exchange exchange(zero, nullptr);
  EXPECT_EQ(exchange.numbers_from(1), (std::vector<double>{0.1, -1e-310}));
  EXPECT_EQ(exchange.bytes_from(1), "");
  EXPECT_EQ(exchange.bytes_from(2), "a");
  EXPECT_EQ(exchange.bytes_from(2), "b");
}

TEST(Exchange, EndsWaitingWhenStoppedOrWhenARankHasFailed) {
  Network network(3);
  const Ranks zero = network.rank(0);
  StopFlag stop{true};
  EXPECT_THROW((void)Exchange(zero, &stop).bytes_from(1), Interrupted);
  // As end_ranks() of rank 2 sends it.
  const auto failed_with = [&](const char* parcel) {
    network.rank(2).send(0, parcel);
    (void)Exchange(zero, nullptr).bytes_from(1);
  };
  EXPECT_THROW(failed_with("f130 interrupted"), Interrupted);
  EXPECT_THROW(failed_with("f3 no convergence"), std::runtime_error);
  try {
    failed_with("f2 its file is gone");
    FAIL() << "went on";
  } catch (const InvalidInputOfRank& error) {
    EXPECT_STREQ(error.what(), "rank 2: its file is gone");
  }
}

// As end_ranks() sends it: it must not be taken for an exchange's, or the rank waits for it for ever.
TEST(Exchange, DoesNotTakeWhatIsNotItsOwn) {
  Network network(3);
  const Ranks two = network.rank(2);
  network.rank(0).send(2, std::string(1, kGoParcel));
  try {
    (void)Exchange(two, nullptr).bytes_from(1);
    FAIL() << "went on";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "exchange: rank 2 got 'G' of rank 0, which is not for it");
  }
}

}  // namespace
}  // namespace slipmode
