"""A Bennett linkage: how far it moves, where its parts are in a pose, its solids to model on."""

from __future__ import annotations

from math import degrees, radians

from fabrication import kit


def main() -> None:
    """The certified range of a linkage, its bill of materials, and a stand for it in build123d."""
    toy = kit("bennett", a_mm=90, alpha_deg=35, beta_deg=75, parts={"pin": "printed"})
    low, high = degrees(toy.motion.low), degrees(toy.motion.high)
    print(f"{toy.summary()}, free from {low:.1f} to {high:.1f} deg")
    for contact in toy.motion.contacts:
        print(f"{' meets '.join(contact.marks)} at {degrees(contact.t):.1f} deg")
    for row in toy.schedules["bom"].filter(lambda row: row["role"] == "link"):
        print(f"{row['count']} x {row['number']}: {row['length_mm']:.3f} mm, {row['hand']} hand")
    placed = toy.motions([radians(40), radians(120)])
    way = placed["L-0001"][1, :3, 3] - placed["L-0001"][0, :3, 3]
    print(f"L-0001 moves by {', '.join(f'{step:.1f}' for step in way)} mm")

    import build123d as b3

    pose = toy.to_build123d(radians(120))
    box = pose.bounding_box()
    foot = b3.Pos(0, 0, box.min.Z - 5) * b3.Box(40, 40, 10)
    print(f"build123d: {len(pose.solids())} solids on a foot of {foot.volume / 1e3:.0f} cm3")


if __name__ == "__main__":
    main()
