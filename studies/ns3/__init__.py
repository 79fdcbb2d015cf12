"""The network of the paper's simulation study: ns-3's Wi-Fi, driven beside a team's agenda."""
