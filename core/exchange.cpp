#include <slipmode/core/exchange.hpp>

#include <fmt/format.h>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

namespace slipmode {

namespace {

constexpr char kExchangeParcel = 'e';
constexpr auto kLook = std::chrono::microseconds(100);  // between two looks for what has arrived

}  // namespace

Exchange::Exchange(const Ranks& ranks, const StopFlag* stop)
    : ranks_(ranks), stop_(stop), arrived_(static_cast<std::size_t>(ranks.count)) {}

void Exchange::send(int to, std::string_view bytes) const {
  std::string parcel;
  parcel.reserve(1 + bytes.size());
  parcel += kExchangeParcel;
  parcel += bytes;
  ranks_.send(to, std::move(parcel));
}

void Exchange::send(int to, std::span<const double> numbers) const {
  send(to, std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
}

std::string Exchange::bytes_from(int rank) {
  auto& waiting = arrived_[static_cast<std::size_t>(rank)];
  while (waiting.empty()) {
    check_interrupt();
    auto parcel = ranks_.receive();
    if (!parcel) {
      std::this_thread::sleep_for(kLook);
      continue;
    }
    if (const auto failure = failure_in(*parcel)) failure->rethrow();
    if (parcel->bytes.front() != kExchangeParcel) {
      throw std::logic_error(fmt::format("exchange: rank {} got '{}' of rank {}, which is not for it", ranks_.own,
                                         parcel->bytes.front(), parcel->from));
    }
    arrived_[static_cast<std::size_t>(parcel->from)].push_back(parcel->bytes.substr(1));
  }
  std::string bytes = std::move(waiting.front());
  waiting.pop_front();
  return bytes;
}

std::vector<double> Exchange::numbers_from(int rank) {
  const std::string bytes = bytes_from(rank);
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

void Exchange::check_interrupt() const {
  if (stop_ != nullptr && stop_->load()) throw Interrupted();
}

}  // namespace slipmode
