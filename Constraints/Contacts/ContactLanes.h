// Copies single contacts from and to batches of any width.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

#include <cstddef>
#include <cstring>

namespace fulcrum::contacts {

// The members from the normal to the end, which depend on the manifold, are arrays of lanes without gaps, in batches of
// any width.
template <int N, bool kFixedB>
struct LaneRegion {
    using Batch = ContactBatch<N, kFixedB>;
    static constexpr size_t kBegin = offsetof(Batch, normal),
                            kEnd = offsetof(Batch, twistRadius) + sizeof(Batch::twistRadius);
    static constexpr size_t kCount = (kEnd - kBegin) / (N * sizeof(float));
    static_assert(kBegin + kCount * N * sizeof(float) == kEnd);
};

template <class Batch>
std::byte* FloatAt(Batch& batch, size_t begin, size_t i, int width, int lane) {
    return reinterpret_cast<std::byte*>(&batch) + begin +
           (i * static_cast<size_t>(width) + static_cast<size_t>(lane)) * sizeof(float);
}

// Calls copy(float of the lane, float of the other batch) for all of them.
template <int N, bool kFixedB, class Copy>
void VisitLane(ContactBatch<N, kFixedB>& batch, int lane, ContactBatch<1, kFixedB>& single, Copy&& copy) {
    using Region = LaneRegion<N, kFixedB>;
    using Single = LaneRegion<1, kFixedB>;
    static_assert(Region::kCount == Single::kCount);
    for (size_t i = 0; i < Region::kCount; ++i)
        copy(FloatAt(batch, Region::kBegin, i, N, lane), FloatAt(single, Single::kBegin, i, 1, 0));
}

// Writes the contact of a lane to a batch of its own.
template <int N, bool kFixedB>
void ReadLane(ContactBatch<N, kFixedB>& batch, int lane, ContactBatch<1, kFixedB>& single) {
    VisitLane(batch, lane, single, [](const void* from, void* to) { std::memcpy(to, from, sizeof(float)); });
    single.contact[0] = batch.contact[lane];
    single.bodyA[0] = batch.bodyA[lane];
    single.bodyB[0] = batch.bodyB[lane];
    single.count = 1;
    single.pointCount = batch.pointCount;
    single.bounces = batch.bounces;
    single.hasNotes = batch.hasNotes;
    single.hasSurface = batch.hasSurface;
    single.gentle = batch.gentle >> lane & 1;
    single.isGuided = batch.isGuided;
    single.locks[0] = single.locksOfAll = single.locksOfSome = batch.locks[lane];
    single.inverseSoftDepth = batch.inverseSoftDepth[lane];
}

}  // namespace fulcrum::contacts
