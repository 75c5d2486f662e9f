#include <Fulcrum/Physics/Stages/DirectContacts.h>

#include <Fulcrum/Constraints/Contacts/ContactKernels.h>
#include <Fulcrum/Physics/Stages/DirectRows.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace fulcrum {

namespace {

using namespace direct;

// gamma of rows with little impulse, as a part of J M^-1 J^T, and how many times less it may be.
constexpr double kPointSoftness = 1e-3, kMostStiffer = 16384;
// Rows are solved anew where they give way by more than this times what they may.
constexpr double kMostBeyond = 2;
// Of a body's size, what a contact gives way in a substep: at rest it sinks by that over `baumgarte`.
constexpr double kMostSink = 2e-4;

// m: by how much separations are off, because of their floats and of the grid of positions.
double RoundingOf(double size) { return kRounding * size + kPositionGrid; }

// Calls visit(point) for the points in use of a lane.
template <class Batch, class Visit>
void VisitPoints(const Batch& batch, int lane, Visit&& visit) {
    for (int i = 0; i < batch.pointCount; ++i)
        if (batch.rows[i].inverseResponse[lane] > 0) visit(i);
}

// Whether a point hits, in this substep, so fast that it bounces. row: without its gap.
bool IsHit(const BodyStore& bodies, std::span<const DirectBody> island, const uint32_t* indices, const DirectRow& row,
           double gap, double h, double slowest) {
    double approach = -row.c, gained = 0;
    const auto add = [&](uint32_t body, uint32_t index, const double(&j)[6]) {
        for (int k = 0; k < 6; ++k) approach -= j[k] * island[body].velocity[k];
        for (int k = 0; k < 3; ++k) gained -= j[k] * double{bodies.poses[index].acceleration[k]} * h;
    };
    add(row.a, indices[0], row.ja);
    if (row.b != DirectRow::kNone) add(row.b, indices[1], row.jb);
    return approach * h >= gap && approach - std::max(gained, 0.0) > slowest;
}

}  // namespace

template <class Visit>
void DirectContacts::VisitBatches(Visit&& visit) const {
    fulcrum::VisitBatches(layout_, group_, [&](auto& batch) {
        if constexpr (requires { batch.frictionImpulse; }) visit(batch);
    });
}

DirectContacts::DirectContacts(BodyStore& bodies, SolverLayout& layout, const SolverGroup& group,
                               std::span<const uint32_t> localOf, double h, double give, ScratchArena& scratch)
    : bodies_(bodies), layout_(layout), group_(group), localOf_(localOf), h_(h), give_(give) {
    size_t lanes = 0;
    VisitBatches([&](const auto& batch) { lanes += static_cast<size_t>(batch.count); });
    contacts_ = scratch.Allocate<Contact>(lanes);
    patches_ = scratch.Allocate<DirectPatch>(lanes);
    std::ranges::fill(contacts_, Contact{});
}

bool DirectContacts::MayBeSolvedDirectly(const PairStore& pairs) const {
    bool mayBe = true;
    VisitBatches([&](const auto& batch) {
        for (int lane = 0; lane < batch.count; ++lane)
            mayBe &= fulcrum::MayBeSolvedDirectly(bodies_, pairs, batch.contact[lane], batch.bodyB[lane]);
    });
    return mayBe;
}

bool DirectContacts::AddRows(std::span<const DirectBody> island, const ContactSolveSettings& settings,
                             std::span<DirectRow> rows, size_t& count) {
    patchCount_ = 0;
    bool bounces = false;
    auto contact = contacts_.begin();
    VisitBatches([&]<int N, bool kFixedB>(const ContactBatch<N, kFixedB>& batch) {
        contacts::SurfaceMotion<Wide<N>> surface{Wide<N>(0.0f), Wide<N>(0.0f), Wide<N>(0.0f)};
        if (batch.hasSurface) surface = contacts::GatherSurfaceMotion(batch, settings.rare->surfaceVelocities);
        for (int lane = 0; lane < batch.count; ++lane, ++contact) {
            const uint32_t a = localOf_[batch.bodyA[lane]];
            uint32_t b = DirectRow::kNone;
            const Vector n = InDouble(batch.normal, lane), t1 = InDouble(batch.tangent1, lane),
                         t2 = InDouble(batch.tangent2, lane), armA = InDouble(batch.armA, lane);
            Vector armB = Vector::Zero(), linear = Vector::Zero(), angular = Vector::Zero();
            if constexpr (kFixedB) {
                angular = InDouble(batch.sideB.velocity.angular, lane);
                linear = InDouble(batch.sideB.velocity.linear, lane) +
                         InDouble(batch.sideB.acceleration, lane) * double{settings.elapsed};
            } else {
                b = localOf_[batch.bodyB[lane]];
                armB = InDouble(batch.sideB.arm, lane);
            }
            // torque: about the center of the manifold.
            const auto add = [&](const Vector& force, const Vector& torque, float impulse) -> DirectRow& {
                DirectRow& row = rows[count++];
                row = DirectRow{};
                row.a = a;
                row.b = b;
                Set(row.ja, -force, -(Cross<double>(armA, force) + torque));
                if (b != DirectRow::kNone) Set(row.jb, force, Cross<double>(armB, force) + torque);
                row.c = Dot<double>(force, linear) + Dot<double>(torque, angular);
                row.impulse = double{impulse};
                const double k = ResponseOf(island, row);
                row.inverseGamma = k > 0 ? 1 / (kPointSoftness * k) : 0;
                return row;
            };
            double size = std::sqrt(Dot<double>(armA, armA));
            if constexpr (!kFixedB) size = std::min(size, std::sqrt(Dot<double>(armB, armB)));
            *contact = {.first = static_cast<uint32_t>(count),
                        .normals = 0,
                        .hasFriction = false,
                        .stiffness = 1,
                        .size = size};
            const float restitution = batch.bounces ? settings.rare->records[batch.contact[lane]].restitution : 0.0f;
            const uint32_t indices[2] = {batch.bodyA[lane], batch.bodyB[lane]};
            VisitPoints(batch, lane, [&](int i) {
                const auto& point = batch.rows[i];
                const double gap = std::max(double{point.separation[lane]} - RoundingOf(size), 0.0);
                DirectRow& row = add(n, t1 * double{point.b[lane]} - t2 * double{point.a[lane]}, point.impulse[lane]);
                if (restitution > 0)
                    bounces |= IsHit(bodies_, island, indices, row, gap, h_, double{settings.restitutionSpeed});
                row.c += gap / h_;
                row.lo = 0;
                ++contact->normals;
            });
            if (contact->normals > 0 && batch.friction[lane] > 0) {
                contact->hasFriction = true;
                patches_[patchCount_++] = {contact->first, contact->normals, double{batch.friction[lane]},
                                           double{batch.twistRadius[lane]}};
                DirectRow& x = add(t1, Vector::Zero(), batch.frictionImpulse[0][lane]);
                DirectRow& y = add(t2, Vector::Zero(), batch.frictionImpulse[1][lane]);
                DirectRow& twist = add(Vector::Zero(), n, batch.frictionImpulse[2][lane]);
                x.inverseGamma = y.inverseGamma = std::min(x.inverseGamma, y.inverseGamma);
                x.c += double{surface.v1[lane]};
                y.c += double{surface.v2[lane]};
                twist.c += double{surface.spin[lane]};
            }
            Stiffen(*contact, rows, 1);
        }
    });
    return !bounces;
}

bool DirectContacts::Stiffen(Contact& contact, std::span<DirectRow> rows, double beyond) const {
    double most = 0;
    for (const DirectRow& row : rows.subspan(contact.first, contact.normals))
        if (row.inverseGamma > 0) most = std::max(most, row.impulse / row.inverseGamma);
    const double give = std::min(give_, kMostSink * contact.size / h_);
    if (!(most > beyond * give)) return false;
    const double times = std::min(most / give, kMostStiffer / contact.stiffness);
    if (!(times > 1)) return false;
    contact.stiffness *= times;
    for (DirectRow& row : contact.RowsOf(rows)) row.inverseGamma *= times;
    return true;
}

bool DirectContacts::Stiffen(std::span<DirectRow> rows) {
    bool any = false;
    for (Contact& contact : contacts_) any |= Stiffen(contact, rows, kMostBeyond);
    return any;
}

void DirectContacts::ReadImpulses(std::span<const DirectRow> rows) {
    auto contact = contacts_.begin();
    VisitBatches([&](auto& batch) {
        for (int lane = 0; lane < batch.count; ++lane, ++contact) {
            uint32_t next = contact->first;
            const auto read = [&](auto& impulse) { impulse.Set(lane, static_cast<float>(rows[next++].impulse)); };
            VisitPoints(batch, lane, [&](int i) { read(batch.rows[i].impulse); });
            for (int k = 0; k < 3 && contact->hasFriction; ++k) read(batch.frictionImpulse[k]);
        }
    });
}

void DirectContacts::ForgetImpulses() {
    VisitBatches([](auto& batch) {
        for (auto& row : batch.rows) row.impulse = decltype(row.impulse)(0.0f);
        for (auto& impulse : batch.frictionImpulse) impulse = std::remove_reference_t<decltype(impulse)>(0.0f);
    });
}

bool DirectContacts::AddCorrections(std::span<const DirectRow> rows, const ContactSolveSettings& settings,
                                    std::span<DirectRow> to, size_t& count) const {
    const double slop = double{settings.slop}, part = double{settings.baumgarte}, most{settings.mostCorrection};
    bool any = false;
    auto contact = contacts_.begin();
    size_t patch = 0;
    VisitBatches([&](const auto& batch) {
        for (int lane = 0; lane < batch.count; ++lane, ++contact) {
            const auto add = [&](const DirectRow& row) -> DirectRow& {
                DirectRow& added = to[count++] = row;
                added.c = added.impulse = 0;
                return added;
            };
            uint32_t next = contact->first;
            double sum = 0;
            VisitPoints(batch, lane, [&](int i) {
                const DirectRow& row = rows[next++];
                const double separation = double{batch.rows[i].separation[lane]}, within = separation + slop;
                DirectRow& added = add(row);
                const double correction = part * (separation > 0 ? separation : std::min(within, 0.0));
                if (row.impulse > 0) {
                    // What carries a load stays in contact: then this is no search.
                    added.lo = -DirectRow::kUnlimited;
                    added.c = std::clamp(correction, -most, most);
                } else {
                    added.c = within < 0 ? std::max(correction, -most) : within;
                }
                any |= within < -RoundingOf(contact->size);
                sum += row.impulse;
            });
            if (!contact->hasFriction) continue;
            const DirectPatch& limits = patches_[patch++];
            const double limit = DirectPatch::kHolding * limits.friction * sum, x = rows[next].impulse,
                         y = rows[next + 1].impulse;
            if (x * x + y * y < limit * limit) {
                add(rows[next]);
                add(rows[next + 1]);
            }
            if (std::abs(rows[next + 2].impulse) < limit * limits.twistRadius) add(rows[next + 2]);
        }
    });
    return any;
}

void DirectContacts::UpdateSeparations(const ContactSolveSettings& settings) {
    VisitBatches([&](auto& batch) { fulcrum::UpdateSeparations(batch, bodies_.states.data(), settings); });
}

}  // namespace fulcrum
