"""What Sendworthy does, or would have done, with recorded traffic: `sendworthy replay`."""
