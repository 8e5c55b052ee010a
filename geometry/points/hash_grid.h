/// Hash map from the cells of a sparse grid to values, for inner loops. It uses open addressing
/// with linear probing and a maximum load factor of one half. Keys of up to 63 bits identify cells,
/// for example 21 bits per axis.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace skycap::geometry {

/// `Value` should be cheap to copy. Store large values elsewhere and keep their index or pointer in
/// the map.
template <typename Value>
class HashGrid {
 public:
  /// Reserves space for `cells` cells. The map grows beyond that automatically.
  explicit HashGrid(std::size_t cells = 512) {
    set_slots(std::bit_ceil(std::max<std::size_t>(2 * cells, 2)));
  }

  std::size_t size() const { return size_; }
  std::size_t memory() const { return slots_.capacity() * sizeof(Slot); }  ///< [bytes]

  /// Returns the value of a key, or null. The pointer is valid until the next insert().
  const Value* find(std::uint64_t key) const {
    const Slot& slot = slots_[find_slot(key)];
    return slot.key == key ? &slot.value : nullptr;
  }
  Value* find(std::uint64_t key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

  struct Inserted {
    Value& value;  ///< valid until the next insert()
    bool is_new = false;
  };
  /// Sets the value of a key unless the key exists. Returns the stored value.
  Inserted insert(std::uint64_t key, const Value& value = {}) {
    std::size_t slot = find_slot(key);
    if (slots_[slot].key == key) return {slots_[slot].value, false};
    if (2 * (size_ + 1) > slots_.size()) {
      grow();
      slot = find_slot(key);
    }
    slots_[slot] = {key, value};
    ++size_;
    return {slots_[slot].value, true};
  }

 private:
  static constexpr std::uint64_t no_key = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t key = no_key;
    [[no_unique_address]] Value value{};
  };

  void set_slots(std::size_t count) {  // `count` must be a power of two
    slots_.assign(count, Slot{});
    shift_ = 64 - std::countr_zero(count);
  }

  /// Returns the slot of a key, or the empty slot for its insertion. Uses Fibonacci hashing: the
  /// high bits of the product depend on all bits of the key.
  std::size_t find_slot(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = static_cast<std::size_t>(key * 0x9E3779B97F4A7C15U >> shift_);
    while (slots_[slot].key != key && slots_[slot].key != no_key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    std::vector<Slot> old = std::move(slots_);
    set_slots(2 * old.size());
    for (const Slot& slot : old) {
      if (slot.key != no_key) slots_[find_slot(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  int shift_ = 0;  ///< 64 - log2 of the number of slots
  std::size_t size_ = 0;
};

}  // namespace skycap::geometry
