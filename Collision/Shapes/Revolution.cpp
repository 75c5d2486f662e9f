#include <Fulcrum/Collision/Shapes/Revolution.h>

#include <Fulcrum/Collision/Shapes/SizeChecks.h>

namespace fulcrum {

RevolutionPiece BallSlice(double from, double to, double center, double radius) {
    const double below = from - center;
    return {from, to, (radius - below) * (radius + below), -2 * below, -1};
}

RevolutionPiece Frustum(double from, double to, double lower, double upper) {
    const double slope = (upper - lower) / (to - from);
    return {from, to, lower * lower, 2 * lower * slope, slope * slope};
}

SolidMass RevolutionMass(std::span<const RevolutionPiece> pieces) {
    double area = 0, first = 0, second = 0, fourth = 0;  // integrals of r^2, r^2 y, r^2 y^2 and r^4
    for (const RevolutionPiece& p : pieces) {
        const double l = p.to - p.from;
        const auto moment = [&](int k) {
            double power = 1;
            for (int i = 0; i <= k; ++i) power *= l;
            return power * (p.c0 / (k + 1) + l * (p.c1 / (k + 2) + l * p.c2 / (k + 3)));
        };
        const double m0 = moment(0), m1 = moment(1), m2 = moment(2);
        area += m0;
        first += p.from * m0 + m1;
        second += p.from * p.from * m0 + 2 * p.from * m1 + m2;
        fourth += l * (p.c0 * p.c0 + l * (p.c0 * p.c1 + l * ((p.c1 * p.c1 + 2 * p.c0 * p.c2) / 3 +
                                                             l * (p.c1 * p.c2 / 2 + l * p.c2 * p.c2 / 5))));
    }
    SolidMass solid;
    const double center = first / area;
    solid.volume = kPi * area;
    solid.center = Position(0, center, 0);
    solid.inertia.yy = kPi / 2 * fourth;
    solid.inertia.xx = solid.inertia.zz = kPi * (fourth / 4 + second - center * first);
    return solid;
}

}  // namespace fulcrum
