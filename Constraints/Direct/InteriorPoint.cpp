#include <Fulcrum/Constraints/Direct/InteriorPoint.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr double kUnlimited = DirectRow::kUnlimited;
// The part of the way to a limit that a step goes at most.
constexpr double kInside = 0.99;
// At the beginning impulses are away from a limit by this part of the range, if there are two.
constexpr double kRoom = 0.3;

// `part` of a step, or less of it where `distance` would become less than it may.
double PartWithin(double part, double distance, double change) {
    return change < 0 && -change * part > kInside * distance ? kInside * distance / -change : part;
}

}  // namespace

InteriorPoint::InteriorPoint(DirectModel& model, ScratchArena& scratch)
    : model_(model),
      rows_(scratch.Allocate<Limited>(model.rows_.size())),
      discs_(scratch.Allocate<Disc>(model.patches_.size())) {
    for (size_t r = 0; r < rows_.size(); ++r) {
        const auto& [a, b] = model.jacobians_[r];
        rows_[r] = {};
        rows_[r].response = Dot(a, a) + Dot(b, b);
    }
    std::ranges::fill(discs_, Disc{});
}

void InteriorPoint::AssembleSoft(const BlockMatrix& matrix, std::span<const Column6> y) {
    model_.FindSpeeds(y);
    const auto set = [&](size_t r, double d, bool isLimited) {
        Limited& in = rows_[r];
        in.weight = d > 0 ? 1 / (1 / d + (isLimited ? in.response : 0.0)) : 0.0;
        in.target = -in.weight * model_.rows_[r].speed;
    };
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        set(r, row.d, row.lo > -kUnlimited || row.hi < kUnlimited);
    }
    for (const Patch& patch : model_.patches_)
        for (uint32_t k = 0; k < 2; ++k) set(patch.tangent + k, patch.d, true);
    model_.AssembleMasses(matrix);
    AddWeighted(matrix);
    SetGradient(y);
}

void InteriorPoint::Begin(std::span<const Column6> y, double speed) {
    // From y = 0 the step was y.
    model_.FindStepSpeeds(y);
    const auto begin = [&](Multiplier& multiplier, double value) {
        multiplier = {.value = std::max(std::abs(value), speed), .change = 0, .aim = 0};
    };
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        Limited& in = rows_[r];
        in.impulse = in.target - in.weight * row.stepSpeed;
        if (!(row.d > 0) || !(row.hi > row.lo)) {
            in.impulse = row.d > 0 ? row.lo : 0;
            continue;
        }
        in.hasLow = row.lo > -kUnlimited;
        in.hasHigh = row.hi < kUnlimited;
        if (!in.hasLow && !in.hasHigh) continue;
        const double room = std::min(kRoom * (row.hi - row.lo), std::max(std::abs(in.impulse), speed / in.response));
        in.impulse = std::min(std::max(in.impulse, row.lo + room), row.hi - room);
        const double slack = row.speed + in.impulse / row.d;
        if (in.hasLow) begin(in.low, slack);
        if (in.hasHigh) begin(in.high, slack);
    }
    for (size_t i = 0; i < discs_.size(); ++i) {
        const Patch& patch = model_.patches_[i];
        const Row *rows = &model_.rows_[patch.tangent], &twist = rows[2];
        begin(discs_[i].multiplier, std::sqrt(rows[0].speed * rows[0].speed + rows[1].speed * rows[1].speed));
        Limited* in = &rows_[patch.tangent];
        in[0].impulse = in[1].impulse = in[2].impulse = 0;
        in[2].hasLow = in[2].hasHigh = twist.d > 0 && patch.twistRadius > 0;
        begin(in[2].low, twist.speed);
        begin(in[2].high, twist.speed);
    }
}

void InteriorPoint::Assemble(const BlockMatrix& matrix) {
    for (size_t i = 0; i < discs_.size(); ++i) {
        Patch& patch = model_.patches_[i];
        Disc& disc = discs_[i];
        double sum = 0;
        for (uint32_t r = patch.firstNormal; r < patch.tangent; ++r) sum += std::max(rows_[r].impulse, 0.0);
        model_.SetLimit(patch, patch.friction * sum);
        Limited* in = &rows_[patch.tangent];
        // Impulses keep their part of the limit.
        if (patch.limitBefore > 0 && patch.limitBefore < kUnlimited)
            for (int k = 0; k < 3; ++k) in[k].impulse *= patch.limit / patch.limitBefore;
        disc.isUsed = patch.limit > 0 && patch.d > 0;
        if (!disc.isUsed) continue;
        const double f1 = in[0].impulse, f2 = in[1].impulse, limit = patch.limit, m = disc.multiplier.value;
        disc.room = (limit * limit - f1 * f1 - f2 * f2) / (2 * limit);
        // The inverse of (gamma + m / L) I + m / (room L^2) f f^T.
        const double diagonal = 1 / patch.d + m / limit, outer = m / (disc.room * limit * limit);
        const double determinant = diagonal * (diagonal + outer * (f1 * f1 + f2 * f2));
        disc.xx = (diagonal + outer * f2 * f2) / determinant;
        disc.yy = (diagonal + outer * f1 * f1) / determinant;
        disc.xy = -outer * f1 * f2 / determinant;
    }
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        Limited& in = rows_[r];
        in.weight = 0;
        if (!(row.d > 0) || !(row.hi > row.lo)) continue;
        double inverse = 1 / row.d;
        if (in.hasLow) inverse += in.low.value / (in.impulse - row.lo);
        if (in.hasHigh) inverse += in.high.value / (row.hi - in.impulse);
        in.weight = 1 / inverse;
    }
    model_.AssembleMasses(matrix);
    AddWeighted(matrix);
    AddDiscs(matrix);
}

void InteriorPoint::AddWeighted(const BlockMatrix& matrix) const {
    DirectProducts products;
    for (const DirectModel::Run& run : model_.runs_) {
        for (uint32_t r = run.begin; r < run.end; ++r) {
            if (!(rows_[r].weight > 0)) continue;
            if (products.IsFull()) model_.AddToMatrix(products, run, matrix);
            products.Add(model_.jacobians_[r].a, model_.jacobians_[r].b, rows_[r].weight);
        }
        model_.AddToMatrix(products, run, matrix);
    }
}

void InteriorPoint::AddDiscs(const BlockMatrix& matrix) const {
    DirectProducts products;
    for (size_t i = 0; i < discs_.size(); ++i) {
        const Disc& disc = discs_[i];
        if (!disc.isUsed) continue;
        const Patch& patch = model_.patches_[i];
        const auto &j1 = model_.jacobians_[patch.tangent], &j2 = model_.jacobians_[patch.tangent + 1];
        // xx (j1 + ratio j2)^2 + rest j2^2
        const double ratio = disc.xy / disc.xx, rest = disc.yy - ratio * disc.xy;
        const auto sum = [&](const Column6& x, const Column6& y) {
            Column6 result;
            (Lanes6(x) + Lanes6(y) * ratio).StoreTo(result);
            return result;
        };
        products.Add(sum(j1.a, j2.a), sum(j1.b, j2.b), disc.xx);
        products.Add(j2.a, j2.b, rest);
        model_.AddToMatrix(products, model_.runs_[patch.run], matrix);
    }
}

void InteriorPoint::SetGradient(std::span<const Column6> y) {
    model_.FindGradientOfMasses(y);
    for (const DirectModel::Run& run : model_.runs_) {
        Column6 &a = model_.gradient_[run.a], &b = model_.gradient_[run.b];
        Lanes6 ga(a), gb(b);
        for (uint32_t r = run.begin; r < run.end; ++r) {
            ga = ga - Lanes6(model_.jacobians_[r].a) * rows_[r].target;
            gb = gb - Lanes6(model_.jacobians_[r].b) * rows_[r].target;
        }
        ga.StoreTo(a);
        gb.StoreTo(b);
    }
}

void InteriorPoint::Aim(std::span<const Column6> y, double mu, Order order) {
    const bool isSecond = order == Order::Second;
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        Limited& in = rows_[r];
        in.target = in.impulse;
        if (!(in.weight > 0)) continue;
        double push = -(row.speed + in.impulse / row.d);
        if (in.hasLow) {
            in.low.aim = mu - (isSecond ? in.change * in.low.change : 0.0);
            push += in.low.aim / (in.impulse - row.lo);
        }
        if (in.hasHigh) {
            in.high.aim = mu + (isSecond ? in.change * in.high.change : 0.0);
            push -= in.high.aim / (row.hi - in.impulse);
        }
        in.target += in.weight * push;
    }
    for (size_t i = 0; i < discs_.size(); ++i) {
        const Patch& patch = model_.patches_[i];
        Disc& disc = discs_[i];
        if (!disc.isUsed) continue;
        Multiplier& m = disc.multiplier;
        m.aim = mu - (isSecond ? m.change * disc.change - m.value * disc.curvature : 0.0);
        Limited* in = &rows_[patch.tangent];
        const double inwards = m.aim / (disc.room * patch.limit);
        double push[2];
        for (int k = 0; k < 2; ++k)
            push[k] = -(model_.rows_[patch.tangent + k].speed + in[k].impulse / patch.d) - inwards * in[k].impulse;
        in[0].target = in[0].impulse + (disc.xx * push[0] + disc.xy * push[1]);
        in[1].target = in[1].impulse + (disc.xy * push[0] + disc.yy * push[1]);
    }
    SetGradient(y);
}

void InteriorPoint::FindChanges(std::span<const Column6> step) {
    model_.FindStepSpeeds(step);
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        Limited& in = rows_[r];
        in.change = 0;
        if (!(in.weight > 0)) continue;
        in.change = in.target - in.impulse - in.weight * row.stepSpeed;
        if (in.hasLow) in.low.change = (in.low.aim - in.low.value * in.change) / (in.impulse - row.lo) - in.low.value;
        if (in.hasHigh)
            in.high.change = (in.high.aim + in.high.value * in.change) / (row.hi - in.impulse) - in.high.value;
    }
    for (size_t i = 0; i < discs_.size(); ++i) {
        const Patch& patch = model_.patches_[i];
        Disc& disc = discs_[i];
        if (!disc.isUsed) continue;
        Limited *in = &rows_[patch.tangent], &x = in[0], &y = in[1];
        const double speedX = model_.rows_[patch.tangent].stepSpeed, speedY = model_.rows_[patch.tangent + 1].stepSpeed;
        x.change = x.target - x.impulse - (disc.xx * speedX + disc.xy * speedY);
        y.change = y.target - y.impulse - (disc.xy * speedX + disc.yy * speedY);
        disc.change = -(x.impulse * x.change + y.impulse * y.change) / patch.limit;
        disc.curvature = (x.change * x.change + y.change * y.change) / (2 * patch.limit);
        Multiplier& m = disc.multiplier;
        m.change = (m.aim - m.value * disc.change) / disc.room - m.value;
    }
}

double InteriorPoint::LargestPart() const {
    double part = 1;
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        const Limited& in = rows_[r];
        if (in.hasLow) {
            part = PartWithin(part, in.impulse - row.lo, in.change);
            part = PartWithin(part, in.low.value, in.low.change);
        }
        if (in.hasHigh) {
            part = PartWithin(part, row.hi - in.impulse, -in.change);
            part = PartWithin(part, in.high.value, in.high.change);
        }
    }
    for (const Disc& disc : discs_) {
        if (!disc.isUsed) continue;
        part = PartWithin(part, disc.multiplier.value, disc.multiplier.change);
        if (!(disc.curvature > 0)) continue;
        const double root = std::sqrt(disc.change * disc.change + 4 * disc.curvature * disc.room);
        part = std::min(part, kInside * (disc.change + root) / (2 * disc.curvature));
    }
    return part;
}

double InteriorPoint::MeanProduct(double part) const {
    double sum = 0, count = 0;
    const auto add = [&](const Multiplier& m, double distance) {
        sum += (m.value + part * m.change) * distance;
        ++count;
    };
    for (size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = model_.rows_[r];
        const Limited& in = rows_[r];
        const double impulse = in.impulse + part * in.change;
        if (in.hasLow) add(in.low, impulse - row.lo);
        if (in.hasHigh) add(in.high, row.hi - impulse);
    }
    for (const Disc& disc : discs_)
        if (disc.isUsed) add(disc.multiplier, disc.room + part * disc.change - part * part * disc.curvature);
    return count > 0 ? sum / count : 0;
}

void InteriorPoint::Advance(std::span<Column6> y, std::span<const Column6> step, double part) {
    for (Limited& in : rows_) {
        in.impulse += part * in.change;
        in.low.value += part * in.low.change;
        in.high.value += part * in.high.change;
    }
    for (Disc& disc : discs_)
        if (disc.isUsed) disc.multiplier.value += part * disc.multiplier.change;
    for (size_t i = 0; i < step.size(); ++i) (Lanes6(y[i]) + Lanes6(step[i]) * part).StoreTo(y[i]);
}

}  // namespace fulcrum
