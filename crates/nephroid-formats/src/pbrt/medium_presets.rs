//! Media that pbrt knows by name.

/// Name, reduced scattering and absorption per millimetre, of Jensen, Marschner, Levoy and Hanrahan (2001, *A
/// Practical Model for Subsurface Light Transport*, figure 5).
const PRESETS: [(&str, [f32; 3], [f32; 3]); 12] = [
    ("Apple", [2.29, 2.39, 1.97], [0.0030, 0.0034, 0.046]),
    ("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    ("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20]),
    ("Cream", [7.38, 5.47, 3.15], [0.0002, 0.0028, 0.0163]),
    ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("Marble", [2.19, 2.62, 3.00], [0.0021, 0.0041, 0.0071]),
    ("Potato", [0.68, 0.70, 0.55], [0.0024, 0.0090, 0.12]),
    ("Skimmilk", [0.70, 1.22, 1.90], [0.0014, 0.0025, 0.0142]),
    ("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("Skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("Spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0]),
    ("Wholemilk", [2.55, 3.21, 3.77], [0.0011, 0.0024, 0.014]),
];

/// Those that pbrt has beside them, dilute liquids of another table.
#[rustfmt::skip]
pub(super) const OTHERS: &[&str] = &[
    "Lowfat Milk", "Reduced Milk", "Regular Milk", "Espresso", "Mint Mocha Coffee", "Lowfat Soy Milk",
    "Regular Soy Milk", "Lowfat Chocolate Milk", "Regular Chocolate Milk", "Coke", "Pepsi", "Sprite", "Gatorade",
    "Chardonnay", "White Zinfandel", "Merlot", "Budweiser Beer", "Coors Light Beer", "Clorox", "Apple Juice",
    "Cranberry Juice", "Grape Juice", "Ruby Grapefruit Juice", "White Grapefruit Juice", "Shampoo",
    "Strawberry Shampoo", "Head & Shoulders Shampoo", "Lemon Tea Powder", "Orange Powder", "Pink Lemonade Powder",
    "Cappuccino Powder", "Salt Powder", "Sugar Powder", "Suisse Mocha Powder", "Pacific Ocean Surface Water",
];

/// Scattering and absorption.
pub(super) fn preset(name: &str) -> Option<[[f32; 3]; 2]> {
    PRESETS
        .iter()
        .find(|(known, ..)| *known == name)
        .map(|(_, scattering, absorption)| [*scattering, *absorption])
}

/// Every name, for proposals.
pub(super) fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, ..)| *name).chain(OTHERS.iter().copied())
}
